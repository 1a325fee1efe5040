// The page of a comparison: `report` is the JSON of `caustica compare --json`; `views` holds pixels as
// base64 of little-endian 16-bit floats, histograms and crops, one entry per comparison.

const report = embedded('report'), views = embedded('views');
const [imageName, referenceName] = report.labels ?? ['image', 'reference'];
let index = 0;  // comparison shown
const comparison = () => report.comparisons[index];
const view = () => views[index];
const ids = ['panes', 'layers', 'slider', 'exposure', 'stops', 'fit', 'beside', 'curve'];
const viewer = new Viewer(Object.fromEntries(ids.map(id => [id, byId(id)])), read);

function select(wanted) {
  index = clamp(wanted, 0, report.comparisons.length - 1);
  const v = view(), layers = [
    { name: imageName, data: halves(v.image) },
    { name: referenceName, data: halves(v.reference) },
    { name: 'LDR-FLIP', data: halves(v.flip), map: true },
  ];
  if (v.hdr_flip) layers.push({ name: 'HDR-FLIP', data: halves(v.hdr_flip), map: true });
  // First what decides how much room the panes have.
  describe();
  viewer.fitted = true;
  viewer.show(layers, v.width, v.height);
  for (const [i, button] of byId('list').querySelectorAll('button').entries()) {
    button.setAttribute('aria-current', i === index);
  }
}

// --- words and numbers --------------------------------------------------------------------------

function read(px, py) {
  const { width, reduced } = view();
  const place = reduced > 1 ? `block of ${reduced}×${reduced} pixels at (${px * reduced}, ${py * reduced})` : `pixel (${px}, ${py})`;
  byId('readout').textContent = viewer.readout(place, py * width + px);
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
  const lines = names.map((n, k) => `<line x1="${left}" x2="${left + width}" y1="${y(10 ** -k)}" y2="${y(10 ** -k)}" class="grid"/><text x="${left - 6}" y="${y(10 ** -k) + 4}" text-anchor="end">${n}</text>`);
  const ticks = [0, 0.2, 0.4, 0.6, 0.8, 1].map(v => `<text x="${x(v)}" y="${top + height + 15}" text-anchor="middle">${v}</text>`);
  return `<svg viewBox="0 0 ${left + width + 16} ${top + height + 36}" role="img" aria-label="Histogram of LDR-FLIP">${lines.join('')}${bars.join('')}
<line x1="${x(mean)}" x2="${x(mean)}" y1="${top}" y2="${top + height}" class="mark"/><text x="${x(mean) + 4}" y="${top - 4}">mean ${number(mean)}</text>
<line x1="${left}" x2="${left + width}" y1="${top + height}" y2="${top + height}" class="axis"/>${ticks.join('')}
<text x="${left + width / 2}" y="${top + height + 31}" text-anchor="middle">LDR-FLIP of a pixel (share of pixels, logarithmic)</text></svg>`;
}

function crop(c) {
  const figure = (name, png) => element('figure', {},
    element('img', { src: `data:image/png;base64,${png}`, alt: name }), element('figcaption', { textContent: name }));
  const button = element('button', { type: 'button', className: 'crop', title: 'zoom to this place' },
    element('div', {}, figure(imageName, c.image), figure(referenceName, c.reference), figure('LDR-FLIP', c.flip)),
    `(${c.x}, ${c.y}), ${c.width}×${c.height} pixels, mean FLIP ${number(c.mean)}`);
  button.onclick = () => {
    const { reduced } = view();
    viewer.zoomTo(c.x / reduced, c.y / reduced, c.width / reduced, c.height / reduced);
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
  viewer.listen(key => ({ ArrowUp: () => select(index - 1), ArrowDown: () => select(index + 1) })[key]);
  viewer.stops = report.comparisons[0].flip_ldr.exposure;
  select(0);
}

start();
