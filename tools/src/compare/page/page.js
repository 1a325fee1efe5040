'use strict';
// The page of a comparison: `report` is the JSON of `caustica compare --json`; `views` holds pixels as
// base64 of little-endian 16-bit floats, histograms and crops, one entry per comparison.

const byId = id => document.getElementById(id);
const embedded = id => JSON.parse(byId(id).textContent);
const report = embedded('report'), views = embedded('views'), magma = embedded('magma');
const [imageName, referenceName] = report.labels ?? ['image', 'reference'];

// --- pixels -------------------------------------------------------------------------------------

/** Value of each of the 65536 half floats. */
const halfValue = Float32Array.from({ length: 65536 }, (_, h) => {
  const sign = h & 0x8000 ? -1 : 1, exponent = (h >> 10) & 31, fraction = h & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
});

function halves(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new Uint16Array(bytes.buffer);
}

/** Display byte of each half float at an exposure in stops: sRGB, clamped. */
function displayTable(stops) {
  const factor = 2 ** stops;
  return Uint8Array.from(halfValue, v => {
    const x = Math.min(Math.max(v * factor, 0), 1);
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055) + 0.5;
  });
}

function paint(layer, width, height, table) {
  const canvas = document.createElement('canvas');
  canvas.width = width; canvas.height = height;
  const context = canvas.getContext('2d'), image = context.createImageData(width, height), out = image.data;
  for (let i = 0, o = 0; o < out.length; i++, o += 4) {
    if (layer.map) {
      const c = magma[Math.min(255, Math.max(0, Math.round(255 * halfValue[layer.data[i]])))];
      out[o] = c[0]; out[o + 1] = c[1]; out[o + 2] = c[2];
    } else {
      for (let k = 0; k < 3; k++) out[o + k] = table[layer.data[3 * i + k]];
    }
    out[o + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

// --- state --------------------------------------------------------------------------------------

const state = {
  index: 0,        // comparison shown
  position: 0,     // slider: 0 image, 1 reference, 2 LDR-FLIP, 3 HDR-FLIP; fractions wipe
  stops: 0,
  beside: false,
  view: { scale: 1, x: 0, y: 0 },  // screen = (pixel − (x, y)) · scale
  fitted: true,
  layers: [],
};

const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const comparison = () => report.comparisons[state.index];
const view = () => views[state.index];

function select(index) {
  state.index = clamp(index, 0, report.comparisons.length - 1);
  const v = view();
  state.layers = [
    { name: imageName, data: halves(v.image) },
    { name: referenceName, data: halves(v.reference) },
    { name: 'LDR-FLIP', data: halves(v.flip), map: true },
  ];
  if (v.hdr_flip) state.layers.push({ name: 'HDR-FLIP', data: halves(v.hdr_flip), map: true });
  state.position = Math.min(state.position, state.layers.length - 1);
  state.fitted = true;
  byId('slider').max = state.layers.length - 1;
  byId('layers').replaceChildren(...state.layers.map((layer, i) => {
    const button = element('button', { type: 'button', textContent: `${i + 1} ${layer.name}` });
    button.onclick = () => moveTo(i);
    return button;
  }));
  develop();
  describe();
  for (const [i, button] of byId('list').querySelectorAll('button').entries()) {
    button.setAttribute('aria-current', i === state.index);
  }
  arrange();
}

/** Pictures of all layers at the exposure set. */
function develop() {
  const table = displayTable(state.stops), { width, height } = view();
  for (const layer of state.layers) {
    if (!layer.canvas || !layer.map) layer.canvas = paint(layer, width, height, table);
  }
}

function moveTo(position) {
  state.position = clamp(position, 0, state.layers.length - 1);
  draw();
}

function expose(stops) {
  state.stops = clamp(stops, -10, 10);
  develop();
  draw();
}

// --- panes --------------------------------------------------------------------------------------

/** One pane, or one per layer; all share one view, so zoom and pan stay together. */
function arrange() {
  const count = state.beside ? state.layers.length : 1;
  byId('panes').replaceChildren(...Array.from({ length: count }, () => {
    const pane = element('div', { className: 'pane' });
    const canvas = element('canvas');
    pane.append(canvas, element('span'), element('span'));
    navigate(canvas);
    return pane;
  }));
  byId('slider').disabled = state.beside;
  byId('beside').checked = state.beside;
  draw();
}

function fit(canvas) {
  const { width, height } = view(), w = canvas.clientWidth, h = canvas.clientHeight;
  const scale = Math.min(w / width, h / height);
  state.view = { scale, x: (width - w / scale) / 2, y: (height - h / scale) / 2 };
}

function draw() {
  const panes = [...document.querySelectorAll('.pane')];
  if (state.fitted) fit(panes[0].querySelector('canvas'));
  panes.forEach((pane, i) => drawPane(pane, state.beside ? i : state.position));
  byId('slider').value = state.position;
  byId('exposure').value = state.stops;
  byId('stops').textContent = `${state.stops > 0 ? '+' : ''}${state.stops}`;
  [...byId('layers').children].forEach((b, i) => b.setAttribute('aria-pressed', !state.beside && i === Math.round(state.position)));
}

function drawPane(pane, position) {
  const canvas = pane.querySelector('canvas'), ratio = devicePixelRatio || 1;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  const context = canvas.getContext('2d'), { scale, x, y } = state.view, { width, height } = view();
  const below = Math.floor(position), part = position - below;
  context.imageSmoothingEnabled = scale * ratio < 1;
  const put = layer => {
    context.setTransform(scale * ratio, 0, 0, scale * ratio, -x * scale * ratio, -y * scale * ratio);
    context.drawImage(layer.canvas, 0, 0, width, height);
    context.setTransform(1, 0, 0, 1, 0, 0);
  };
  put(state.layers[below]);
  const [left, right] = pane.querySelectorAll('span');
  left.textContent = state.layers[part > 0 ? below + 1 : below].name;
  right.textContent = part > 0 ? state.layers[below].name : '';
  right.hidden = part === 0;
  if (part > 0) {
    // The divider crosses the picture, not the pane.
    const from = Math.max(-x * scale, 0), to = Math.min((width - x) * scale, canvas.clientWidth);
    const edge = (from + part * (to - from)) * ratio;
    context.save();
    context.beginPath();
    context.rect(0, 0, edge, canvas.height);
    context.clip();
    context.fillStyle = '#1b1b1b';
    context.fillRect(0, 0, edge, canvas.height);
    put(state.layers[below + 1]);
    context.restore();
    context.fillStyle = '#fff';
    context.fillRect(edge - ratio / 2, 0, ratio, canvas.height);
  }
}

function navigate(canvas) {
  let grabbed = null;
  canvas.onpointerdown = e => { grabbed = { x: e.clientX, y: e.clientY, view: { ...state.view } }; canvas.setPointerCapture(e.pointerId); };
  canvas.onpointerup = () => { grabbed = null; };
  canvas.onpointermove = e => {
    if (grabbed) {
      const { view: v } = grabbed;
      state.fitted = false;
      state.view = { scale: v.scale, x: v.x - (e.clientX - grabbed.x) / v.scale, y: v.y - (e.clientY - grabbed.y) / v.scale };
      draw();
    }
    const { scale, x, y } = state.view;
    read(Math.floor(e.offsetX / scale + x), Math.floor(e.offsetY / scale + y));
  };
  canvas.onwheel = e => {
    e.preventDefault();
    zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY);
  };
  canvas.ondblclick = refit;
}

function zoom(factor, sx, sy) {
  const { scale, x, y } = state.view, next = clamp(scale * factor, 0.02, 200);
  state.fitted = false;
  state.view = { scale: next, x: x + sx / scale - sx / next, y: y + sy / scale - sy / next };
  draw();
}

function refit() { state.fitted = true; draw(); }

// --- words and numbers --------------------------------------------------------------------------

function element(tag, properties = {}, ...children) {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
}

const number = v => v === null || v === undefined ? '–' : v === 0 ? '0' : Number(v.toPrecision(6)).toString();
const percent = v => `${number(100 * v)} %`;

function read(px, py) {
  const { width, height, reduced } = view();
  if (px < 0 || py < 0 || px >= width || py >= height) return;
  const i = py * width + px, [image, reference, ...maps] = state.layers;
  const rgb = layer => [0, 1, 2].map(k => halfValue[layer.data[3 * i + k]]);
  const show = v => v.map(c => (c < 0 ? '' : ' ') + c.toPrecision(4)).map(s => s.padEnd(11)).join(' ');
  const a = rgb(image), b = rgb(reference);
  const where = reduced > 1 ? `block of ${reduced}×${reduced} pixels at (${px * reduced}, ${py * reduced})` : `pixel (${px}, ${py})`;
  byId('readout').textContent = `${where}   ${maps.map(m => `${m.name} ${halfValue[m.data[i]].toFixed(4)}`).join('   ')}
${imageName.padEnd(10)} ${show(a)}
${referenceName.padEnd(10)} ${show(b)}
difference ${show(a.map((v, k) => v - b[k]))}`;
}

/** A cell that shows one number of the report; `metric` is its path in the comparison's JSON. */
function cell(metric, format = number) {
  const value = metric.split('.').reduce((v, key) => v?.[key], comparison());
  const td = element('td', { textContent: value === null || value === undefined ? '–' : format(value) });
  td.dataset.metric = metric;
  return td;
}

function describe() {
  const c = comparison(), v = view();
  byId('title').textContent = report.labels ? `${c.name}: before and after` : c.name;
  document.title = `${c.name}: caustica compare`;
  const verdict = byId('verdict');
  verdict.textContent = c.checks.length === 0 ? 'no threshold set' : c.holds ? 'all thresholds hold' : 'a threshold does not hold';
  verdict.className = c.checks.length === 0 ? '' : c.holds ? 'holds' : 'fails';
  const size = v.reduced > 1 ? `, shown as means of ${v.reduced}×${v.reduced} pixels` : '';
  byId('files').textContent = `${c.image} against ${c.reference}, ${c.width}×${c.height} pixels${size}`;
  const row = (name, ...cells) => element('tr', {}, element('th', { textContent: name }), ...cells);
  const head = (...names) => row(names[0], ...names.slice(1).map(n => element('th', { textContent: n })));
  const per = (path, format) => [0, 1, 2].map(k => cell(`${path}.${k}`, format));
  const gap = tr => { tr.className = 'gap'; return tr; };
  const flip = (name, path) => row(name, ...['mean', 'median', 'p95', 'p99'].map(k => cell(`${path}.${k}`)));
  const rows = [
    head('', 'R', 'G', 'B', 'all'),
    row('mean', ...per('bias.image_mean')),
    row(`mean, ${referenceName}`, ...per('bias.reference_mean')),
    row('bias', ...per('bias.absolute'), cell('bias.absolute_all')),
    row('bias, relative', ...per('bias.relative', percent), cell('bias.relative_all', percent)),
    row('RMSE', ...per('rmse'), cell('rmse_all')),
    gap(row('relMSE', cell('relmse'))),
    row('relMSE, trimmed', cell('relmse_trimmed')),
    row('MAPE', cell('mape', percent)),
    row('PSNR, dB', cell('psnr')),
    gap(head('', 'mean', 'median', '95 %', '99 %')),
    flip('LDR-FLIP', 'flip_ldr'),
  ];
  if (c.flip_hdr) {
    rows.push(flip('HDR-FLIP', 'flip_hdr'));
    const x = c.flip_hdr.exposures;
    rows.push(row('exposures', element('td', { colSpan: 4, textContent: `${x.count} from ${x.start.toFixed(2)} to ${x.stop.toFixed(2)} stops, ${c.flip_hdr.tonemapper}` })));
  }
  if (c.z_test) {
    rows.push(gap(row(`z-test ${c.z_test.accepted ? 'accepted' : 'rejected'}`, cell('z_test.accepted_share', percent))));
    rows.push(row('within 4.5 σ', cell('z_test.within_4_5_sigma', percent)));
    rows.push(row('mean of z²', cell('z_test.mean_z2')));
  }
  byId('metrics').replaceChildren(element('tbody', {}, ...rows));
  byId('checks').replaceChildren(...c.checks.map(k => element('li', {
    className: k.holds ? 'holds' : 'fails',
    textContent: `${k.name}: ${number(k.value)}, limit ${number(k.limit)}: ${k.holds ? 'holds' : 'fails'}`,
  })));
  byId('notes').replaceChildren(...c.notes.map(n => element('li', { textContent: n })));
  byId('histogram').innerHTML = histogram(v.histogram, c.flip_ldr.mean);
  byId('crops').replaceChildren(...v.crops.map(crop));
}

/** Bars of the share of pixels per hundredth of FLIP, on a logarithmic scale. */
function histogram(shares, mean) {
  const left = 52, top = 16, width = 480, height = 180, lowest = -6;
  const y = share => top + height * clamp(Math.log10(share) / lowest, 0, 1);
  const x = flip => left + width * flip;
  const wide = width / shares.length;
  const bars = shares.map((s, i) => s === 0 ? '' :
    `<rect x="${x(i / shares.length)}" y="${y(s)}" width="${wide - 0.5}" height="${top + height - y(s)}" fill="rgb(${magma[Math.round((i + 0.5) / shares.length * 200 + 55)]})"/>`);
  const names = ['100 %', '10 %', '1 %', '0.1 %', '0.01 %', '0.001 %'];
  const lines = names.map((n, k) => `<line x1="${left}" x2="${left + width}" y1="${y(10 ** -k)}" y2="${y(10 ** -k)}" stroke="#4a4a4a"/><text x="${left - 6}" y="${y(10 ** -k) + 4}" text-anchor="end">${n}</text>`);
  const ticks = [0, 0.2, 0.4, 0.6, 0.8, 1].map(v => `<text x="${x(v)}" y="${top + height + 15}" text-anchor="middle">${v}</text>`);
  return `<svg viewBox="0 0 ${left + width + 16} ${top + height + 36}" role="img" aria-label="Histogram of LDR-FLIP">${lines.join('')}${bars.join('')}
<line x1="${x(mean)}" x2="${x(mean)}" y1="${top}" y2="${top + height}" stroke="#fff" stroke-dasharray="4 3"/><text x="${x(mean) + 4}" y="${top - 4}">mean ${number(mean)}</text>
<line x1="${left}" x2="${left + width}" y1="${top + height}" y2="${top + height}" stroke="#a8a8a8"/>${ticks.join('')}
<text x="${left + width / 2}" y="${top + height + 31}" text-anchor="middle">LDR-FLIP of a pixel (share of pixels, logarithmic)</text></svg>`;
}

function crop(c) {
  const figure = (name, png) => element('figure', {},
    element('img', { src: `data:image/png;base64,${png}`, alt: name }), element('figcaption', { textContent: name }));
  const button = element('button', { type: 'button', className: 'crop', title: 'zoom to this place' },
    element('div', {}, figure(imageName, c.image), figure(referenceName, c.reference), figure('LDR-FLIP', c.flip)),
    `(${c.x}, ${c.y}), ${c.width}×${c.height} pixels, mean FLIP ${number(c.mean)}`);
  button.onclick = () => {
    const canvas = document.querySelector('.pane canvas'), { reduced } = view();
    const scale = Math.min(canvas.clientWidth, canvas.clientHeight) / (Math.max(c.width, c.height) / reduced) / 1.5;
    const centre = [(c.x + c.width / 2) / reduced, (c.y + c.height / 2) / reduced];
    state.fitted = false;
    state.view = { scale, x: centre[0] - canvas.clientWidth / 2 / scale, y: centre[1] - canvas.clientHeight / 2 / scale };
    draw();
    canvas.scrollIntoView({ block: 'nearest' });
  };
  return button;
}

// --- start --------------------------------------------------------------------------------------

function start() {
  const problems = [
    ...report.failures.map(f => `could not compare: ${f.error}`),
    ...report.unmatched.map(i => `no reference for ${i}`),
  ];
  byId('problems').replaceChildren(...problems.map(p => element('li', { className: 'fails', textContent: p })));
  byId('problems').hidden = problems.length === 0;
  if (report.comparisons.length === 0) {
    byId('title').textContent = 'nothing was compared';
    byId('comparison').hidden = true;
    return;
  }
  byId('list').hidden = report.comparisons.length < 2;
  byId('list').replaceChildren(...report.comparisons.map((c, i) => {
    const button = element('button', { type: 'button' },
      element('img', { src: `data:image/png;base64,${views[i].thumbnail}`, alt: '' }),
      element('span', { textContent: c.name, className: c.checks.length === 0 ? '' : c.holds ? 'holds' : 'fails' }),
      element('small', { textContent: `FLIP ${number(c.flip_ldr.mean)}` }));
    button.onclick = () => select(i);
    return button;
  }));
  byId('slider').oninput = e => moveTo(Number(e.target.value));
  byId('exposure').oninput = e => expose(Number(e.target.value));
  byId('beside').onchange = e => { state.beside = e.target.checked; arrange(); };
  byId('fit').onclick = refit;
  onresize = draw;
  onkeydown = e => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const actions = {
      ' ': () => moveTo(Math.round(state.position) === 0 ? 1 : 0),
      s: () => { state.beside = !state.beside; arrange(); },
      f: refit,
      '+': () => expose(state.stops + 0.5), '=': () => expose(state.stops + 0.5), '-': () => expose(state.stops - 0.5),
      ArrowUp: () => select(state.index - 1), ArrowDown: () => select(state.index + 1),
    };
    const layer = Number(e.key);
    const action = layer >= 1 && layer <= state.layers.length ? () => moveTo(layer - 1) : actions[e.key.toLowerCase()] ?? actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  };
  state.stops = report.comparisons[0].flip_ldr.exposure;
  select(0);
}

start();
