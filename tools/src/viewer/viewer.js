'use strict';
// What the page of a comparison and the live page share: pictures of half floats on canvases that zoom, pan, wipe
// and show values. `magma` in the document holds the 256 colours of error maps.

const byId = id => document.getElementById(id);
const embedded = id => JSON.parse(byId(id).textContent);
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const number = v => v === null || v === undefined ? '–' : v === 0 ? '0' : Number(v.toPrecision(6)).toString();
const percent = v => `${number(100 * v)} %`;

function element(tag, properties = {}, ...children) {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
}

// --- values and colours -------------------------------------------------------------------------

const magma = embedded('magma');

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

const srgb = x => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;

/** Tone curves: display value, 0 to 1, of a linear one from 0. */
const curves = {
  sRGB: x => srgb(Math.min(x, 1)),
  // The rational fit of the ACES curve by K. Narkowicz (2016).
  filmic: x => srgb(Math.min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1)),
  Reinhard: x => srgb(x / (1 + x)),
  'gamma 2.2': x => Math.min(x, 1) ** (1 / 2.2),
  linear: x => Math.min(x, 1),
};

/** Display byte of each half float at an exposure in stops. */
function displayTable(stops, curve = 'sRGB') {
  const factor = 2 ** stops, tone = curves[curve];
  return Uint8Array.from(halfValue, v => 255 * tone(Math.min(Math.max(v * factor, 0), 65504)) + 0.5);
}

/** The value of the brightest colour of an error map: 1, 2 or 5 times a power of ten that 99 % of the pixels reach at most. */
function mapScale(data) {
  // Half floats that are not negative are ordered as their bits.
  const high = halfValue[Uint16Array.from(data).sort()[Math.floor(0.99 * (data.length - 1))]];
  return [0.01, 0.02, 0.05, 0.1, 0.2, 0.5].find(scale => scale >= high) ?? 1;
}

// --- viewer -------------------------------------------------------------------------------------

/** From this many screen pixels a picture's pixel on, its values are written into it. */
const LEGIBLE = 44;

/**
 * Layers `{ name, data, map }` of one size: `data` holds half floats, three a pixel, or one where `map` asks for
 * the colours of an error map, whose brightest stands for `scale`. A layer without data is blank. Position 0 shows the first layer, 1 the second;
 * between them a divider wipes from one to the other.
 *
 * `ui` names elements: panes, layers (buttons), slider, exposure, stops, fit, and if present beside and curve.
 * `point(x, y)` is called with the pixel under the pointer.
 */
class Viewer {
  constructor(ui, point) {
    Object.assign(this, { ui, point, layers: [], width: 1, height: 1, position: 0, stops: 0, curve: 'sRGB' });
    this.beside = false;
    this.fitted = true;
    this.view = { scale: 1, x: 0, y: 0 };  // screen = (pixel − (x, y)) · scale
    this.table = displayTable(0);
    ui.slider.oninput = e => this.moveTo(Number(e.target.value));
    ui.exposure.oninput = e => this.expose(Number(e.target.value));
    ui.fit.onclick = () => this.refit();
    if (ui.beside) ui.beside.onchange = e => this.arrange(e.target.checked);
    if (ui.curve) {
      ui.curve.replaceChildren(...Object.keys(curves).map(name => element('option', { textContent: name })));
      ui.curve.onchange = e => { this.curve = e.target.value; this.develop(); this.draw(); };
    }
    addEventListener('resize', () => this.draw());
  }

  /** Takes new layers in place of the old ones. */
  show(layers, width, height) {
    if (width !== this.width || height !== this.height) this.fitted = true;
    Object.assign(this, { layers, width, height });
    this.position = Math.min(this.position, layers.length - 1);
    this.ui.slider.max = layers.length - 1;
    this.ui.layers.replaceChildren(...layers.map((layer, i) => {
      const button = element('button', { type: 'button', textContent: `${i + 1} ${layer.name}` });
      button.onclick = () => this.moveTo(i);
      return button;
    }));
    this.develop();
    this.arrange(this.beside);
  }

  /** Pictures of all layers at the exposure set. */
  develop() {
    this.table = displayTable(this.stops, this.curve);
    for (const layer of this.layers) {
      if (!layer.data || (layer.canvas && layer.map)) continue;
      if (layer.map) this.paintMap(layer);
      else this.paint(layer, 0, 0, this.width, this.height);
    }
  }

  /** Renews an error map with a scale for its values. */
  paintMap(layer) {
    layer.scale = mapScale(layer.data);
    this.paint(layer, 0, 0, this.width, this.height);
  }

  /** Renews a rectangle of a layer whose data have changed; `draw` shows it. */
  paint(layer, left, top, width, height) {
    layer.canvas ??= Object.assign(document.createElement('canvas'), { width: this.width, height: this.height });
    const context = layer.canvas.getContext('2d'), image = context.createImageData(width, height), out = image.data;
    const { data, map } = layer, table = this.table;
    for (let y = 0, o = 0; y < height; y++) {
      for (let i = (top + y) * this.width + left, end = i + width; i < end; i++, o += 4) {
        if (map) {
          const c = magma[clamp(Math.round(255 * halfValue[data[i]] / layer.scale), 0, 255)];
          out[o] = c[0]; out[o + 1] = c[1]; out[o + 2] = c[2];
        } else {
          for (let k = 0; k < 3; k++) out[o + k] = table[data[3 * i + k]];
        }
        out[o + 3] = 255;
      }
    }
    context.putImageData(image, left, top);
  }

  moveTo(position) {
    this.position = clamp(position, 0, this.layers.length - 1);
    this.draw();
  }

  expose(stops) {
    this.stops = clamp(stops, -10, 10);
    this.develop();
    this.draw();
  }

  /** One pane, or one per layer; all share one view, so zoom and pan stay together. */
  arrange(beside) {
    this.beside = beside;
    const { panes, slider, beside: box } = this.ui, count = beside ? this.layers.length : 1;
    if (panes.children.length !== count) {
      panes.replaceChildren(...Array.from({ length: count }, () => {
        const canvas = element('canvas');
        this.navigate(canvas);
        return element('div', { className: 'pane' }, canvas, element('span'), element('span'), legend());
      }));
    }
    slider.disabled = beside || this.layers.length < 2;
    if (box) box.checked = beside;
    this.draw();
  }

  fit(canvas) {
    const { width, height } = this, w = canvas.clientWidth, h = canvas.clientHeight;
    const scale = Math.min(w / width, h / height) || 1;
    this.view = { scale, x: (width - w / scale) / 2, y: (height - h / scale) / 2 };
  }

  draw() {
    const panes = [...this.ui.panes.children];
    if (panes.length === 0 || this.layers.length === 0) return;
    if (this.fitted) this.fit(panes[0].querySelector('canvas'));
    panes.forEach((pane, i) => this.drawPane(pane, this.beside ? i : this.position));
    const { slider, exposure, stops, layers } = this.ui;
    slider.value = this.position;
    exposure.value = this.stops;
    stops.textContent = `${this.stops > 0 ? '+' : ''}${this.stops}`;
    [...layers.children].forEach((b, i) => b.setAttribute('aria-pressed', !this.beside && i === Math.round(this.position)));
  }

  drawPane(pane, position) {
    const canvas = pane.querySelector('canvas'), ratio = devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    const context = canvas.getContext('2d'), { scale, x, y } = this.view, { width, height } = this;
    const below = Math.floor(position), part = position - below;
    const put = layer => {
      if (!layer.canvas) return;
      context.imageSmoothingEnabled = scale * ratio < 1;
      context.setTransform(scale * ratio, 0, 0, scale * ratio, -x * scale * ratio, -y * scale * ratio);
      context.drawImage(layer.canvas, 0, 0, width, height);
      context.setTransform(1, 0, 0, 1, 0, 0);
      if (scale >= LEGIBLE) this.write(context, canvas, layer, ratio);
    };
    put(this.layers[below]);
    const [left, right] = pane.querySelectorAll('span');
    left.textContent = this.layers[part > 0 ? below + 1 : below].name;
    right.textContent = part > 0 ? this.layers[below].name : '';
    right.hidden = part === 0;
    const map = this.layers.slice(below, part > 0 ? below + 2 : below + 1).find(layer => layer.map && layer.canvas);
    const key = pane.querySelector('.legend');
    key.hidden = !map;
    if (map) key.lastChild.textContent = map.scale < 1 ? `${map.scale} and more` : '1';
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
      put(this.layers[below + 1]);
      context.restore();
      context.fillStyle = '#fff';
      context.fillRect(edge - ratio / 2, 0, ratio, canvas.height);
    }
  }

  /** The values of the pixels in sight, each in its pixel. */
  write(context, canvas, layer, ratio) {
    const { scale, x, y } = this.view, side = scale * ratio;
    const lines = layer.map ? 1 : 3, size = Math.min(side / (lines + 1.5), side / 4.2);
    context.font = `${size}px ui-monospace, monospace`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const right = Math.min(this.width, Math.ceil(x + canvas.clientWidth / scale));
    const low = Math.min(this.height, Math.ceil(y + canvas.clientHeight / scale));
    for (let row = Math.max(0, Math.floor(y)); row < low; row++) {
      for (let column = Math.max(0, Math.floor(x)); column < right; column++) {
        const i = row * this.width + column, values = this.values(layer, i);
        const bright = layer.map ? values[0] > 0.6 * layer.scale : this.table[layer.data[3 * i + 1]] > 120;
        context.fillStyle = bright ? '#000' : '#fff';
        values.forEach((v, k) => context.fillText(short(v), (column + 0.5 - x) * side,
          (row - y + 0.5) * side + (k - (lines - 1) / 2) * size * 1.15));
      }
    }
  }

  /** The values of a pixel, three or one. */
  values(layer, i) {
    return layer.map ? [halfValue[layer.data[i]]] : [0, 1, 2].map(k => halfValue[layer.data[3 * i + k]]);
  }

  navigate(canvas) {
    let grabbed = null;
    canvas.onpointerdown = e => { grabbed = { x: e.clientX, y: e.clientY, view: { ...this.view } }; canvas.setPointerCapture(e.pointerId); };
    canvas.onpointerup = () => { grabbed = null; };
    canvas.onpointermove = e => {
      if (grabbed) {
        const { view: v } = grabbed;
        this.fitted = false;
        this.view = { scale: v.scale, x: v.x - (e.clientX - grabbed.x) / v.scale, y: v.y - (e.clientY - grabbed.y) / v.scale };
        this.draw();
      }
      const { scale, x, y } = this.view, px = Math.floor(e.offsetX / scale + x), py = Math.floor(e.offsetY / scale + y);
      if (px >= 0 && py >= 0 && px < this.width && py < this.height) this.point(px, py);
    };
    canvas.onwheel = e => {
      e.preventDefault();
      this.zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY);
    };
    canvas.ondblclick = () => this.refit();
  }

  zoom(factor, sx, sy) {
    const { scale, x, y } = this.view, next = clamp(scale * factor, 0.02, 200);
    this.fitted = false;
    this.view = { scale: next, x: x + sx / scale - sx / next, y: y + sy / scale - sy / next };
    this.draw();
  }

  /** Zooms to a rectangle of the picture. */
  zoomTo(left, top, width, height) {
    const canvas = this.ui.panes.querySelector('canvas'), w = canvas.clientWidth, h = canvas.clientHeight;
    const scale = clamp(Math.min(w, h) / Math.max(width, height) / 1.5, 0.02, 200);
    this.fitted = false;
    this.view = { scale, x: left + width / 2 - w / 2 / scale, y: top + height / 2 - h / 2 / scale };
    this.draw();
    canvas.scrollIntoView({ block: 'nearest' });
  }

  refit() { this.fitted = true; this.draw(); }

  /** The lines of a read-out of a pixel: the layers of radiance, the values of the maps beside the place. */
  readout(place, i, comparable = true) {
    const known = this.layers.filter(layer => layer.data);
    const maps = known.filter(layer => layer.map), rows = known.filter(layer => !layer.map);
    const row = (name, values) => `${name.padEnd(11)}${values.map(c => (c < 0 ? '' : ' ') + c.toPrecision(4)).map(s => s.padEnd(11)).join(' ')}`;
    const lines = rows.map(layer => row(layer.name, this.values(layer, i)));
    if (rows.length === 2 && comparable) {
      const [a, b] = rows.map(layer => this.values(layer, i));
      lines.push(row('difference', a.map((v, k) => v - b[k])));
    }
    return [`${place}   ${maps.map(m => `${m.name} ${this.values(m, i)[0].toFixed(4)}`).join('   ')}`, ...lines].join('\n');
  }

  /** What a key does, or undefined. */
  action(key) {
    const layer = Number(key);
    if (layer >= 1 && layer <= this.layers.length) return () => this.moveTo(layer - 1);
    const brighter = () => this.expose(this.stops + 0.5);
    return {
      ' ': () => this.moveTo(Math.round(this.position) === 0 ? 1 : 0),
      s: () => this.arrange(!this.beside),
      f: () => this.refit(),
      '+': brighter, '=': brighter, '-': () => this.expose(this.stops - 0.5),
    }[key.toLowerCase()];
  }

  /** Answers keys; `more(key)` gives the actions of the page itself. */
  listen(more = () => undefined) {
    onkeydown = e => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      // A focused button takes the space bar, a list its letters.
      if (e.target instanceof HTMLSelectElement || (e.key === ' ' && e.target instanceof HTMLButtonElement)) return;
      const action = more(e.key) ?? this.action(e.key);
      if (!action) return;
      e.preventDefault();
      action();
    };
  }
}

/** What the colours of an error map stand for; the end is filled in. */
function legend() {
  const stops = magma.filter((_, i) => i % 15 === 0).map(c => `rgb(${c})`);
  const bar = element('i');
  bar.style.background = `linear-gradient(to right, ${stops})`;
  return element('div', { className: 'legend', hidden: true }, element('b', { textContent: '0' }), bar, element('b'));
}

/** A value in at most five characters or so. */
function short(v) {
  if (!Number.isFinite(v)) return String(v);
  const size = Math.abs(v);
  if (size === 0) return '0';
  return size >= 1e4 || size < 1e-3 ? v.toExponential(0) : v.toPrecision(3);
}
