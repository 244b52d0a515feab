// Everything that comes from files goes onto the page through here, as text: never as markup.
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.filter(child => child !== null && child !== undefined));
  return node;
}

const DATA = JSON.parse(document.getElementById('data').textContent);
const STATES = ['s0 folded', 's1 unfolded', 's2 open', 's3 filled', 's4 success', 's5 fail'];
const stateName = state => STATES[state] ?? 'lost';
