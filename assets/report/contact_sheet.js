// Tiles of DATA.actions and the filters above them.
function thumbnail(name, when) {
  const stem = `${encodeURIComponent(name)}_${when}`;
  const image = element('img', {src: `${stem}_overlay.png`, alt: `${name}, ${when}`, loading: 'lazy'});
  return element('a', {href: `${stem}.png`}, image);
}

function tile(action) {
  const good = ['advanced', 'success'].includes(action.outcome);
  const truth = action.next_state === action.next_state_true
      ? '' : ` (in truth ${stateName(action.next_state_true)})`;
  const figure = element('figure', {class: 'tile' + (action.disagree ? ' disagree' : '')},
      element('div', {class: 'pair'},
          thumbnail(action.name, 'before'), thumbnail(action.name, 'after')),
      element('figcaption', {},
          element('b', {}, action.name), ` ${stateName(action.state)} → `,
          `${stateName(action.next_state)}${truth}`, element('br'),
          `action ${action.action}, reward ${action.reward.toFixed(3)}, `,
          element('span', {class: good ? 'good' : 'bad'}, action.outcome),
          action.note ? element('div', {class: 'dim'}, action.note) : null));
  return {action, figure};
}

function fill(select, name, values) {
  select.append(element('option', {value: ''}, 'all'));
  for (const value of [...new Set(values)].sort()) {
    select.append(element('option', {value}, name(value)));
  }
}

const tiles = DATA.actions.map(tile);
document.getElementById('tiles').append(...tiles.map(t => t.figure));
const [state, outcome, disagree] =
    ['state', 'outcome', 'disagree'].map(id => document.getElementById(id));
fill(state, stateName, DATA.actions.map(a => a.state));
fill(outcome, value => value, DATA.actions.map(a => a.outcome));

function filter() {
  let shown = 0;
  for (const {action, figure} of tiles) {
    const show = (state.value === '' || String(action.state) === state.value) &&
        (outcome.value === '' || action.outcome === outcome.value) &&
        (!disagree.checked || action.disagree);
    figure.hidden = !show;
    shown += show;
  }
  document.getElementById('count').textContent = `${shown} of ${tiles.length} actions`;
}
for (const input of [state, outcome, disagree]) input.addEventListener('change', filter);
filter();
