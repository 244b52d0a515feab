// Draws DATA (agents/report/report.h) in #report, section by section.
const page = document.getElementById('report');

// Okabe and Ito's palette, told apart by colour-blind readers too.
const COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000'];
const colour = i => COLOURS[i % COLOURS.length];
const percent = share => `${Math.round(100 * share)} %`;

function section(title, ...intro) {
  page.append(element('h2', {}, title), ...intro.map(text => element('p', {class: 'dim'}, text)));
}

function table(head, rows) {
  const cells = (tag, row) => element('tr', {}, ...row.map(cell =>
      cell instanceof Node && cell.tagName === 'TD' ? cell : element(tag, {}, cell ?? '')));
  return element('div', {class: 'scroll'}, element('table', {},
      element('thead', {}, cells('th', head)),
      element('tbody', {}, ...rows.map(row => cells('td', row)))));
}

// ---- estimates: a number, its interval in words, and drawn from 0 to 1 if it is a share

const DIGITS = {rate: 0, reward: 3, min: 0, steps: 0};
function written(x, unit) {
  return unit === 'rate' ? String(Math.round(100 * x)) : x.toFixed(DIGITS[unit] ?? 3);
}

function estimate(e, unit, whose, count = '') {
  const suffix = unit === 'rate' ? ' %' : '';
  const between = e.low === null || e.high === null
      ? '' : ` (${written(e.low, unit)} to ${written(e.high, unit)})`;
  const node = element('div', {class: whose},
      `${whose === 'thesis' ? 'thesis ' : ''}${written(e.value, unit)}${suffix}${between}`);
  if (unit === 'rate') node.append(bar(e));
  if (count) node.append(element('div', {class: 'dim'}, count));
  return node;
}

function bar({value, low, high}) {
  const node = element('div', {class: 'bar'});
  const place = (name, left, width) => {
    const part = element('div', {class: name});
    part.style.left = `${100 * left}%`;
    if (width !== undefined) part.style.width = `${100 * width}%`;
    node.append(part);
  };
  if (low !== null && high !== null) place('span', low, high - low);
  place('tick', value);
  return node;
}

// {successes, n, low, high}
function rate(r, published = null) {
  const td = element('td', {class: 'number'}, r.n === 0 ? '–'
      : estimate({value: r.successes / r.n, low: r.low, high: r.high}, 'rate', 'ours',
          `${r.successes} of ${r.n}`));
  if (published) td.append(estimate(published, 'rate', 'thesis'));
  return td;
}

// ---- charts

function chart(parent, title, datasets, axes) {
  const canvas = element('canvas', {role: 'img', 'aria-label': title});
  parent.append(element('figure', {}, element('h3', {}, title),
      element('div', {class: 'chart'}, canvas)));
  return new Chart(canvas, {
    type: 'line',
    data: {datasets},
    options: {
      animation: false,
      maintainAspectRatio: false,
      interaction: {mode: 'nearest', axis: 'x', intersect: false},
      plugins: {legend: {display: false}},
      scales: {
        x: {type: 'linear', title: {display: true, text: axes.x}, ticks: {precision: 0}},
        y: {title: {display: true, text: axes.y}},
      },
    },
  });
}

// One for all charts below it.
function legend(labels) {
  return element('div', {class: 'legend'}, ...labels.map((label, i) => {
    const swatch = element('span', {class: 'swatch'});
    swatch.style.background = colour(i);
    return element('span', {}, swatch, label);
  }));
}

// A line and the band around it. points: [{x, mean, low, high}]
function banded(label, hue, points) {
  const edge = (of, fill) => ({
    data: points.map(p => ({x: p.x, y: p[of]})),
    borderWidth: 0, pointRadius: 0, pointHitRadius: 0, fill, backgroundColor: hue + '33',
  });
  return [
    edge('low', false),
    edge('high', '-1'),
    {
      label, data: points.map(p => ({x: p.x, y: p.mean})), borderColor: hue, backgroundColor: hue,
      borderWidth: 2, pointRadius: points.length > 1 ? 0 : 3, fill: false,
    },
  ];
}

// ---- sections

function drawRuns(groups) {
  section('Runs', 'Runs that differ in nothing but their seed are one group.');
  page.append(table(['group', 'protocol', 'seeds', 'actions', 'simulated hours', 'folders'],
      groups.map(g => [g.label, g.protocol, g.seeds.join(', '), String(g.actions),
        g.sim_hours.toFixed(1), g.folders.join(', ')])));
}

function drawCurves(groups) {
  section('Learning curves',
      'Mean of the last 20 rewards over the steps learnt in each state: the mean over the seeds, ' +
      'and as a band the lowest and the highest seed.');
  const charts = element('div', {class: 'charts'});
  page.append(legend(groups.map(g => g.label)), charts);
  for (let state = 0; state < 4; ++state) {
    const datasets = groups.flatMap((g, i) => {
      const {mean, low, high} = g.curves[state];
      return banded(g.label, colour(i),
          mean.map((m, k) => ({x: k + 1, mean: m, low: low[k], high: high[k]})));
    });
    if (datasets.every(d => d.data.length === 0)) continue;  // not trained yet
    chart(charts, stateName(state), datasets, {x: 'step in the state', y: 'reward'});
  }
}

function drawTraining(groups) {
  section('Rewards and success in training',
      'Mean reward of the learnt steps (with several seeds: lowest and highest seed), and how many ' +
      'led to a later state, as the camera saw it, with 95 % Wilson intervals. Training explores: ' +
      'this is not how good the policy is. The thesis gives rewards alone (Table 5.5).');
  page.append(table(['group', ...STATES.slice(0, 4)], groups.map(g => [
    g.label, ...g.training.map((r, s) => {
      const cell = rate(r);
      const {mean, low, high} = g.rewards[s];
      if (mean.length === 0) return cell;
      const range = g.seeds.length > 1 ? ` (${low[0].toFixed(3)} to ${high[0].toFixed(3)})` : '';
      cell.prepend(element('div', {}, `reward ${mean[0].toFixed(3)}${range}`));
      const published = g.published_rewards[s];
      if (published) cell.append(estimate(published, 'reward', 'thesis'));
      return cell;
    }),
  ])));
}

function drawEvaluations(groups) {
  const rows = groups.flatMap(g => g.evaluations.map(e => [
    g.label,
    `${e.bag}, ${e.start}, ${e.pose}, at most ${e.repeats} actions in a state` +
        (e.random ? '; random choice' : '') + (e.overrides ? `; ${e.overrides}` : ''),
    rate(e.success, e.published_success),
    String(e.perceived_successes),
    ...e.per_step.map(r => rate(r)),
  ]));
  if (rows.length === 0) return;
  section('Evaluations',
      'Greedy policy (or random choice, where it says so), all seeds together. ' +
      'Success of the whole task by ground truth; of a step: ' +
      'actions that led to a later state, as the camera saw it. 95 % Wilson intervals; the ' +
      'thesis\'s (Tables 5.6 and 5.7; of the whole task only, for it tried steps one by one) are ' +
      'out of 10.');
  page.append(table(['group', 'evaluated on', 'whole task', 'as the camera saw it',
    ...STATES.slice(0, 4)], rows));
}

const TITLES = {
  '5.4': 'Table 5.4: reward in all, training time, steps',
  '5.5': 'Table 5.5: mean reward of each step in training',
  '5.6': 'Table 5.6: success of each step and of the task, Bag 1',
  '5.7': 'Table 5.7: the policy trained on Bag 1 with other bags and poses',
  'fig5.6': 'Figure 5.6: rewards during training',
};

function resultCell(cell) {
  if (!cell) return element('td', {});
  const td = element('td', {class: 'number', title: [...cell.seeds, cell.command].join('\n')});
  const count = cell.n === undefined ? '' : `${cell.successes} of ${cell.n}`;
  td.append(cell.ours ? estimate(cell.ours, cell.unit, 'ours', count)
      : element('div', {class: 'dim'}, cell.seeds.length ? `${cell.seeds.length} seeds so far` : '–'));
  if (cell.published) td.append(estimate(cell.published, cell.unit, 'thesis'));
  return td;
}

// Columns NAME@STEP are points of curves: one chart per NAME, one line per row.
function drawPoints(cells) {
  const charts = element('div', {class: 'charts'});
  const split = cells.filter(c => c.ours).map(c => ({...c, at: c.column.split('@')}));
  const rows = [...new Set(split.map(c => c.row))];
  page.append(legend(rows), charts);
  for (const name of new Set(split.map(c => c.at[0]))) {
    const datasets = rows.flatMap((row, i) => banded(row, colour(i),
        split.filter(c => c.row === row && c.at[0] === name).map(c => ({
          x: Number(c.at[1]), mean: c.ours.value,
          low: c.ours.low ?? c.ours.value, high: c.ours.high ?? c.ours.value,
        }))));
    chart(charts, name, datasets, {x: 'step', y: split[0].unit});
  }
}

function drawTables(tables) {
  if (tables.length === 0) return;
  section('The thesis and ours',
      'Ours over all seeds, with 95 % intervals, above what the thesis prints (its rates are out of ' +
      '10). Bars run from 0 to 100 %. Point at a cell for its seeds and the command that repeats it.');
  for (const {name, file, cells} of tables) {
    page.append(element('h3', {}, TITLES[name] ?? name), element('p', {class: 'dim'}, file));
    if (cells.every(c => c.column.includes('@'))) {
      drawPoints(cells);
      continue;
    }
    const columns = [...new Set(cells.map(c => c.column))];
    page.append(table(['', ...columns], [...new Set(cells.map(c => c.row))].map(row => [
      row, ...columns.map(column =>
          resultCell(cells.find(c => c.row === row && c.column === column))),
    ])));
  }
}

function drawMaps(groups) {
  const shown = groups.filter(g => g.maps.length > 0);
  if (shown.length === 0) return;
  section('Mean reward of each pose point',
      'On a bag in that state: from blue (lowest) to red (highest); hollow where never tried.');
  for (const g of shown) {
    page.append(element('h3', {}, g.label));
    page.append(element('div', {class: 'maps'}, ...g.maps.map(m => element('figure', {},
        element('img', {src: m.src, alt: `reward map, ${stateName(m.state)}`}),
        element('figcaption', {}, `${stateName(m.state)}, seed ${m.seed}`)))));
  }
}

// Pictures one after the other until someone takes the slider.
function slides(frames) {
  const image = element('img', {alt: ''});
  const caption = element('div', {});
  const slider = element('input', {type: 'range', min: 0, max: frames.length - 1, value: 0});
  slider.style.width = '100%';
  const show = () => {
    image.src = frames[slider.value].src;
    caption.textContent = frames[slider.value].caption;
  };
  const timer = setInterval(() => {
    slider.value = (Number(slider.value) + 1) % frames.length;
    show();
  }, 1500);
  slider.addEventListener('input', () => { clearInterval(timer); show(); });
  show();
  return [image, slider, caption];
}

function drawFilms(films) {
  if (films.length === 0) return;
  section('A success and each kind of failure', 'Videos run at four times their speed.');
  const tiles = element('div', {class: 'tiles'});
  page.append(tiles);
  for (const film of films) {
    const figure = element('figure', {class: film.video ? 'film' : 'film still'},
        element('h3', {class: film.success ? 'good' : 'bad'}, film.kind));
    if (film.video) {
      const video = element('video', {controls: '', muted: '', preload: 'auto', src: film.video});
      video.addEventListener('loadedmetadata', () => { video.playbackRate = 4; });
      figure.append(video);
    } else {
      figure.append(...slides(film.frames));
    }
    figure.append(element('figcaption', {class: 'dim'}, film.source,
        film.video_left_out ? `; too large for this page: ${film.video_left_out}` : null));
    tiles.append(figure);
  }
}

drawTables(DATA.tables);
if (DATA.groups.length > 0) {
  drawRuns(DATA.groups);
  drawCurves(DATA.groups);
  drawTraining(DATA.groups);
  drawEvaluations(DATA.groups);
  drawMaps(DATA.groups);
}
drawFilms(DATA.films);
