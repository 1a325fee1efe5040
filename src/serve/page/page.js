// The live page of a render: `info` says what does not change. `state` is asked for again and again and answered when
// there is news; pictures are fetched when theirs is another number than the one shown.

const info = embedded('info');
const [width, height] = info.size;
const client = Math.floor(Math.random() * 2 ** 48);
const ids = ['panes', 'layers', 'slider', 'exposure', 'stops', 'fit', 'curve'];
const viewer = new Viewer(Object.fromEntries(ids.map(id => [id, byId(id)])), read);

/** Values of every layer that was looked at: half floats, and the number of their snapshot. */
const parts = info.layers.map(name => ({ name, data: null, number: 0 }));
let part = 0;     // index of the one that is shown
let state = null;
let pointed = null;

const flip = { name: 'LDR-FLIP', data: null, map: true, number: 0 };
const reference = { name: 'reference', data: null };

// --- pictures -----------------------------------------------------------------------------------

/** What is shown: the chosen layer, and if there is a reference that and the error map. */
function compose() {
  viewer.show(info.reference ? [parts[part], reference, flip] : [parts[part]], width, height);
}

let drawing = false;
function redraw() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    viewer.draw();
    if (pointed) read(...pointed);
  });
}

/** Fetches a layer tile by tile, and shows each as it comes. False when the server does not have it yet. */
async function load(layer, url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`status ${response.status}`);
  if (response.status === 204) return false;
  const bytes = new Uint8Array(Number(response.headers.get('Content-Length')));
  const words = new DataView(bytes.buffer), reader = response.body.getReader();
  const four = at => [0, 4, 8, 12].map(k => words.getUint32(at + k, true));
  let filled = 0, at = 16;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    bytes.set(value, filled);
    filled += value.length;
    if (filled < 16) continue;
    const [number, w, h, channels] = four(0);
    // An error map has its colours once all of it is there.
    const paints = !layer.map && viewer.layers.includes(layer);
    if (!layer.data) {
      layer.data = new Uint16Array(w * h * channels);
      if (paints) viewer.paint(layer, 0, 0, w, h);
    }
    while (at + 16 <= filled) {
      const [x, y, tw, th] = four(at), size = tw * th * channels;
      if (at + 16 + 2 * size > filled) break;
      const values = new Uint16Array(bytes.buffer, at + 16, size);
      for (let row = 0; row < th; row++) {
        layer.data.set(values.subarray(row * tw * channels, (row + 1) * tw * channels), ((y + row) * w + x) * channels);
      }
      if (paints) viewer.paint(layer, x, y, tw, th);
      at += 16 + 2 * size;
    }
    layer.number = number;
    if (paints) redraw();
  }
  if (at !== bytes.length) throw new Error('the answer broke off');
  if (layer.map) {
    viewer.paintMap(layer);
    redraw();
  }
  return true;
}

/** Brings what is shown up to date. */
async function refresh() {
  const now = parts[part];
  if (state.snapshot && now.number !== state.snapshot.number) await load(now, `tiles?layer=${part}`);
  if (info.reference && !reference.data) await load(reference, 'reference');
  if (state.flip && flip.number !== state.flip) await load(flip, 'flip');
  describeLayer();
}

async function choose(index) {
  part = index;
  byId('part').value = index;
  compose();
  describeLayer();
  if (!state || state.phase === 'ended') return;
  try {
    await load(parts[index], `tiles?layer=${index}`);
    describeLayer();
  } catch { /* Said by `follow`. */ }
}

/** Why the layer is not there yet, if it is not. */
function describeLayer() {
  const { name, data } = parts[part];
  const ended = state?.phase === 'ended';
  if (!state) return;
  if (data) {
    if (pointed) read(...pointed);
    else byId('readout').textContent = 'Point at a pixel to read its values.';
    return;
  }
  byId('readout').textContent = ended ? `${name} was not looked at before the end.`
    : state.statistics.passes > 0 ? `${name} comes after the running pass.` : 'The first pass is running.';
}

function read(x, y) {
  pointed = [x, y];
  if (parts[part].data) byId('readout').textContent = viewer.readout(`pixel (${x}, ${y})`, y * width + x, part === 0);
}

// --- words and numbers --------------------------------------------------------------------------

const count = n => n >= 1e9 ? `${(n / 1e9).toFixed(2)} G` : n >= 1e6 ? `${(n / 1e6).toFixed(2)} M` : n >= 1e3 ? `${(n / 1e3).toFixed(2)} k` : String(Math.round(n));
const megabytes = n => n > 0 && n < 1e5 ? `${(n / 1e3).toFixed(1)}\u00a0kB` : `${(n / 1e6).toFixed(1)}\u00a0MB`;
const after = n => `after ${n} ${n === 1 ? 'pass' : 'passes'}`;
const seconds = s => s < 60 ? `${s.toFixed(1)} s` : s < 3600 ? `${Math.floor(s / 60)} min ${Math.floor(s % 60)} s` : `${Math.floor(s / 3600)} h ${Math.floor(s / 60 % 60)} min`;

const phases = { rendering: 'rendering', paused: 'paused', ended: 'ended', lost: 'no connection to the render' };

function say(phase) {
  const waits = state && phase === 'rendering' && (state.stopping ? 'stopping' : state.pausing ? 'pausing after the running pass' : state.saving ? 'saving after the running pass' : '');
  byId('phase').dataset.phase = phase;
  byId('phase').textContent = waits || (phase === 'ended' && state.reason ? `ended: ${state.reason}` : phases[phase]);
  const over = phase === 'ended' || phase === 'lost';
  for (const id of ['pause', 'save', 'stop']) byId(id).disabled = over || state?.stopping;
  byId('pause').textContent = state?.pausing ? 'resume' : 'pause';
  document.title = `${phase === 'rendering' ? '' : `${phases[phase]}: `}${state?.statistics.passes ?? 0} passes, ${info.scene}`;
}

function describe() {
  const s = state.statistics, made = s.passes - s.resumed_passes;
  const rate = n => s.seconds > 0 ? `${count(n / s.seconds)}/s` : '–';
  const rows = [
    ['passes', s.passes + (info.passes ? ` of ${info.passes}` : '')],
    ['time', ''],
    ['a pass', made > 0 ? seconds(s.seconds / made) : '–'],
    ['rays', `${count(s.rays)} (${rate(s.rays)})`],
  ];
  if (s.light_paths > 0) {
    rows.push(['light paths', count(s.light_paths)], ['photons', `${count(s.photons_stored)} (${rate(s.photons_stored)})`]);
    rows.push(['lookups', `${count(s.lookups)}, ${(s.photons_gathered / Math.max(s.lookups, 1)).toFixed(1)} photons each`]);
  }
  if (s.last_radius > 0) rows.push(['radius', `${number(s.first_radius)} to ${number(s.last_radius)}`]);
  if (s.last_caustic_radius > 0) rows.push(['caustic radius', `${number(s.first_caustic_radius)} to ${number(s.last_caustic_radius)}`]);
  rows.push(['memory', `maps\u00a0${megabytes(s.map_bytes)}, film\u00a0${megabytes(s.film_bytes)}, scene\u00a0${megabytes(s.scene_bytes)}`]);
  if (state.error) rows.push(['standard error', `${(100 * state.error[0]).toFixed(3)} % ${after(state.error[1])}${info.target ? `, target ${100 * info.target} %` : ''}`]);
  if (state.snapshot) rows.push(['picture shown', after(state.snapshot.passes)]);
  rows.push(['cost of viewing', `${(100 * state.load).toFixed(2)} % of the render's processor time`]);
  const last = state.curve.at(-1);
  if (last) {
    rows.push(['RMSE', number(last.rmse)], ['relMSE', number(last.relmse)]);
    const flips = state.curve.filter(p => p.flip !== null);
    if (flips.length > 0) rows.push(['LDR-FLIP, mean', `${number(flips.at(-1).flip)} ${after(flips.at(-1).passes)}`]);
  }
  byId('statistics').replaceChildren(element('tbody', {}, ...rows.map(([name, value]) =>
    element('tr', {}, element('th', { textContent: name }), element('td', { textContent: value })))));
  const time = rows.findIndex(([name]) => name === 'time');
  byId('statistics').rows[time].cells[1].id = 'time';
  tick();
  if (state.saved.number > 0) byId('saved').textContent = state.saved.text.replaceAll('\n', ', ');
  if (info.reference) byId('chart').innerHTML = chart(state.curve);
}

/** When the state came, in milliseconds of the page. */
let heard = 0;

/** The time of the render goes on between two states. */
function tick() {
  if (!state || !byId('time')) return;
  const since = state.phase === 'rendering' && byId('phase').dataset.phase !== 'lost' ? (performance.now() - heard) / 1000 : 0;
  byId('time').textContent = seconds(state.seconds + since) + (info.seconds ? ` of ${seconds(info.seconds)}` : '');
}

// --- error against time -------------------------------------------------------------------------

/** The numbers 1, 2 and 5 of every decade around values, from the last below them to the first above; four at least. */
function ticks(values) {
  const all = Array.from({ length: 25 }, (_, i) => [1, 2, 5].map(k => Number(`${k}e${i - 12}`))).flat();
  const low = all.findLastIndex(t => t <= Math.min(...values)), high = all.findIndex(t => t >= Math.max(...values));
  let first = Math.max(low, 0), last = high < 0 ? all.length - 1 : high;
  while (last - first < 3) {
    if (first > 0) first--;
    if (last < all.length - 1) last++;
  }
  return all.slice(first, last + 1);
}

/** Logarithmic axes: seconds from left to right, errors upwards. Numbers only: nothing in it can be markup. */
function chart(curve) {
  const series = [['rmse', 'RMSE'], ['relmse', 'relMSE'], ['flip', 'LDR-FLIP']];
  const points = curve.filter(p => p.seconds > 0);
  const errors = points.flatMap(p => series.map(([key]) => p[key])).filter(v => v > 0);
  if (errors.length === 0) return '<p class="hint">The curve begins with the first picture.</p>';
  const left = 52, top = 8, w = 330, h = 200;
  const across = ticks(points.map(p => p.seconds)), up = ticks(errors);
  const place = (v, ends) => Math.log(v / ends[0]) / Math.log(ends.at(-1) / ends[0]);
  const x = v => left + w * place(v, across), y = v => top + h * (1 - place(v, up));
  // Names that would stand too close are left out.
  const named = (t, list) => list.length <= 7 || t.toExponential().startsWith('1');
  const name = t => t >= 1e-3 && t < 1e5 ? String(t) : t.toExponential();
  const grid = [
    ...up.filter(t => named(t, up)).map(t => `<line class="grid" x1="${left}" x2="${left + w}" y1="${y(t)}" y2="${y(t)}"/><text x="${left - 6}" y="${y(t) + 4}" text-anchor="end">${name(t)}</text>`),
    ...across.filter(t => named(t, across)).map(t => `<line class="grid" x1="${x(t)}" x2="${x(t)}" y1="${top}" y2="${top + h}"/><text x="${x(t)}" y="${top + h + 15}" text-anchor="middle">${name(t)}</text>`),
  ];
  const lines = series.map(([key]) => {
    const known = points.filter(p => p[key] > 0);
    const path = known.map((p, i) => `${i ? 'L' : 'M'}${x(p.seconds).toFixed(1)} ${y(p[key]).toFixed(1)}`).join('');
    return `<path class="${key}" d="${path}"/>${known.map(p => `<circle class="${key}" cx="${x(p.seconds).toFixed(1)}" cy="${y(p[key]).toFixed(1)}" r="${known.length < 3 ? 4 : 2}"/>`).join('')}`;
  });
  const legend = series.map(([key, text], i) => `<text class="${key}" x="${left + 8 + 95 * i}" y="${top + h + 48}">● ${text}</text>`);
  return `<svg viewBox="0 0 ${left + w + 14} ${top + h + 56}" role="img" aria-label="Error against time, both logarithmic">${grid.join('')}${lines.join('')}<text x="${left + w / 2}" y="${top + h + 31}" text-anchor="middle">seconds</text>${legend.join('')}</svg>`;
}

// --- start --------------------------------------------------------------------------------------

const pause = time => new Promise(done => setTimeout(done, time));
const post = what => fetch(what, { method: 'POST' });

/** Asks for news until the render has ended. A page that nobody sees asks for nothing. */
async function follow() {
  for (;;) {
    if (document.hidden) {
      await new Promise(done => document.addEventListener('visibilitychange', done, { once: true }));
      continue;
    }
    try {
      const response = await fetch(`state?client=${client}${state ? `&after=${state.version}` : ''}`);
      if (!response.ok) throw new Error(`status ${response.status}`);
      state = await response.json();
      heard = performance.now();
      say(state.phase);
      describe();
      await refresh();
      if (state.phase === 'ended') return await farewell();
    } catch {
      // The program goes soon after the end of its render.
      if (state?.phase === 'ended') return;
      say('lost');
      await pause(1000);
    }
  }
}

/** Takes the last picture with all its layers, as the server is about to go. */
async function farewell() {
  for (const [i, layer] of parts.entries()) {
    if (state.snapshot && state.ready[i] && layer.number !== state.snapshot.number) await load(layer, `tiles?layer=${i}`);
  }
  // The program may be gone before it answers.
  await post(`bye?client=${client}`).catch(() => undefined);
}

function start() {
  byId('title').textContent = info.scene;
  byId('part').replaceChildren(...info.layers.map((name, i) => element('option', { textContent: name, value: i })));
  byId('part').onchange = e => choose(Number(e.target.value));
  byId('layers').hidden = byId('slider').hidden = byId('errors').hidden = !info.reference;
  byId('keys').textContent = `Keys: ${info.reference ? '1 2 3 picture, reference, error map, space picture/reference, ' : ''}L next layer, P pause, + − exposure, F fit. Wheel zooms, dragging pans; pixels show their values when they are large enough.`;
  byId('pause').onclick = () => post(state?.pausing ? 'resume' : 'pause');
  byId('save').onclick = () => post('save');
  byId('stop').onclick = () => post('stop');
  viewer.stops = clamp(info.exposure, -10, 10);
  viewer.listen(key => ({
    l: () => choose((part + 1) % parts.length),
    p: () => byId('pause').click(),
    s: () => undefined,
  })[key.toLowerCase()]);
  compose();
  say('rendering');
  setInterval(tick, 250);
  follow();
}

start();
