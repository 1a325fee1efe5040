// Appended to a page by tests/page.rs: uses it as a person would and leaves what was seen in the
// document, as JSON in #seen.
(() => {
  const seen = {}, $ = id => document.getElementById(id);
  const canvas = () => document.querySelector('.pane canvas');
  /** Sum of the bytes of a half of the canvas: tells layers apart. */
  const sum = side => {
    const c = canvas(), half = Math.floor(c.width / 2), copy = document.createElement('canvas');
    copy.width = half; copy.height = c.height;
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(c, -side * half, 0);
    const data = context.getImageData(0, 0, half, c.height).data;
    return data.reduce((a, b) => a + b, 0);
  };
  const key = k => window.dispatchEvent(new KeyboardEvent('keydown', { key: k, cancelable: true }));
  const slide = (id, v) => { $(id).value = v; $(id).dispatchEvent(new Event('input')); };
  const look = () => ({ slider: Number($('slider').value), left: sum(0), right: sum(1), label: document.querySelector('.pane span').textContent });

  seen.image = look();
  slide('slider', 1); seen.slidReference = look();
  slide('slider', 0.4); seen.slidHalf = look();
  slide('slider', 2); seen.slidFlip = look();
  key('1'); seen.keyImage = look();
  key('2'); seen.keyReference = look();
  key(' '); seen.keySpace = look();
  slide('exposure', 2); seen.exposed = look(); seen.stops = $('stops').textContent;
  slide('exposure', 0);

  const c = canvas();
  const at = (type, x, y, more) => c.dispatchEvent(new PointerEvent(type, { clientX: c.getBoundingClientRect().x + x, clientY: c.getBoundingClientRect().y + y, pointerId: 1, bubbles: true, cancelable: true, ...more }));
  at('pointermove', c.clientWidth / 2, c.clientHeight / 2); seen.readout = $('readout').textContent;

  key('s'); seen.panes = document.querySelectorAll('.pane').length;
  const first = canvas();
  first.dispatchEvent(new WheelEvent('wheel', { deltaY: -600, clientX: 50, clientY: 50, cancelable: true }));
  seen.zoomed = [...document.querySelectorAll('.pane canvas')].map(p => p.toDataURL().length > 0);
  seen.scale = viewer.view.scale; seen.shared = new Set([...document.querySelectorAll('.pane')].map(() => JSON.stringify(viewer.view))).size;
  key('s'); key('f');

  const numbers = () => Object.fromEntries([...document.querySelectorAll('[data-metric]')].map(e => [e.dataset.metric, e.textContent]));
  seen.comparisons = report.comparisons.map((_, i) => { select(i); return { title: $('title').textContent, numbers: numbers() }; });
  seen.crops = document.querySelectorAll('.crop img').length;
  seen.bars = document.querySelectorAll('#histogram rect').length;
  seen.problems = [...$('problems').children].map(e => e.textContent);
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();
