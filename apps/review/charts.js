// Curves over frames (dygraphs), linked with the timeline: same range, same playhead, click to go there.
// Every plot begins at the same x, so that a playhead runs straight through all of them.
const PLOT_LEFT = 132, PLOT_RIGHT = 8;
const AXES = {
  x: { drawGrid: false, axisLabelWidth: 60 },
  y: { gridLineColor: '#272b31', axisLabelWidth: PLOT_LEFT - 6, gridLineWidth: 1 },
};

class Curve {
  // series: [{name, colour, width, dash, values: row → number, spread: row → ± with options.bars}], rows: a Rows that gives count and frame numbers.
  constructor(timeline, rows, series, options) {
    this.timeline = timeline;
    this.plot = make('div', { class: 'plot' });
    this.line = make('div', { class: 'playhead' });
    this.chips = make('div', { class: 'chips' });
    this.node = make('div', {}, this.chips, make('div', { class: 'chart', style: { height: `${options.height || 190}px` } },
      this.plot, this.line));
    this.rows = rows;
    this.series = series;
    this.options = options;
    timeline.onFrame.push(() => this.movePlayhead());
    timeline.onWindow.push((first, last, source) => {
      if (source !== this && this.graph) this.graph.updateOptions({ dateWindow: [first, last] });
    });
  }

  // dygraphs measures its parent, so it is made once the node is in the page.
  mount() {
    this.graph = new Dygraph(this.plot, this.table(), Object.assign(this.graphOptions(), this.seriesOptions()));
    this.movePlayhead();
  }

  table() {
    const table = [];
    for (let row = 0; row < this.rows.count; ++row) {
      const line = [this.rows.frame(row)];
      for (const series of this.series) {
        const value = series.values(row), spread = series.spread ? series.spread(row) || 0 : 0;
        const known = !isNaN(value);
        line.push(!this.options.bars ? (known ? value : null) : known ? [value - spread, value, value + spread] : [null, null, null]);
      }
      table.push(line);
    }
    const empty = this.series.map(() => this.options.bars ? [null, null, null] : null);
    return table.length > 1 ? table : [[0, ...empty], [1, ...empty]];
  }

  seriesOptions() {
    const perSeries = {};
    for (const series of this.series) {
      perSeries[series.name] = { strokeWidth: series.width || 1.3, strokePattern: series.dash || null };
    }
    return { labels: ['frame', ...this.series.map(series => series.name)], colors: this.series.map(s => s.colour), series: perSeries };
  }

  graphOptions() {
    return {
      axes: AXES, axisLineColor: '#3a4048', dateWindow: this.timeline.window.slice(), legend: 'never',
      stackedGraph: Boolean(this.options.stacked), fillAlpha: 0.55, valueRange: this.options.valueRange || [0, null],
      customBars: Boolean(this.options.bars), underlayCallback: (paint, area, graph) => this.drawBands(paint, area, graph),
      highlightCircleSize: 2.5, rightGap: PLOT_RIGHT, xRangePad: 0, connectSeparatedPoints: false, animatedZooms: false,
      drawCallback: graph => {
        const [first, last] = graph.xAxisRange();
        this.timeline.range(first, last, this);
        if (this.graph) this.movePlayhead();
      },
      clickCallback: (event, x) => this.timeline.show(x),
    };
  }

  // Stretches set off from the rest: options.bands() gives [{first, last, colour}].
  drawBands(paint, area, graph) {
    for (const band of this.options.bands ? this.options.bands() : []) {
      const left = Math.max(area.x, graph.toDomXCoord(band.first)), right = Math.min(area.x + area.w, graph.toDomXCoord(band.last + 1));
      if (right < area.x || left > area.x + area.w) continue;
      paint.fillStyle = band.colour;
      paint.fillRect(left, area.y, Math.max(1.5, right - left), area.h);
    }
  }

  replace(series, options) {
    this.series = series;
    Object.assign(this.options, options);
    if (!this.graph) return;
    this.graph.updateOptions(Object.assign({ file: this.table(), stackedGraph: Boolean(this.options.stacked) }, this.seriesOptions()));
    this.movePlayhead();
  }

  movePlayhead() {
    if (!this.graph) return;
    const x = this.graph.toDomXCoord(this.timeline.frame), area = this.graph.getArea();
    this.line.style.display = x < area.x - 1 || x > area.x + area.w + 1 ? 'none' : 'block';
    this.line.style.left = `${x}px`;
    const row = this.rows.row(this.timeline.frame);
    this.chips.replaceChildren(...this.series.map(series => make('span', {},
      make('i', { style: { background: series.colour } }), series.name,
      make('b', {}, fixed(series.values(row), this.options.digits === undefined ? 2 : this.options.digits)))));
  }
}

function errorSeries(take, chosen) {
  const figures = [];
  const of = row => figures[row] || (figures[row] = take.errorFigures(row));
  const regional = take.regions && take.regions.length > 1;
  const series = [];
  series.push({ name: 'worst marker', colour: '#7c4a48', width: 1, values: row => of(row).worst });
  if (take.globalMeans && regional) {
    series.push({ name: 'mean, global', colour: '#8d949d', width: 1.2, dash: [5, 4],
      values: row => take.globalMeans.at(take.globalMeans.row(take.errors.frame(row)), 0) });
  }
  series.push({ name: regional ? `mean, ${take.regions.length} regions` : 'mean', colour: '#dfa55c', width: 1.8,
    values: row => of(row).mean });
  const q = take.markerNames.indexOf(chosen);
  if (q >= 0) series.push({ name: chosen, colour: '#7fb0d6', width: 1.5, values: row => take.errors.at(row, q) });
  return series;
}

// The poses that matter most in a region, by their mean weight; the neutral is what is left.
function weightSeries(take, region, most) {
  const poses = take.poses.length, means = [];
  for (let i = 1; i < poses; ++i) {
    let sum = 0;
    for (let row = 0; row < take.weights.count; ++row) sum += take.weights.at(row, region * poses + i);
    means.push([sum / take.weights.count, i]);
  }
  means.sort((a, b) => b[0] - a[0]);
  const kept = means.filter(([mean]) => mean > 1e-4).slice(0, most), rest = means.slice(kept.length);
  const series = kept.map(([, i], n) => ({ name: take.poses[i], colour: SERIES[n % SERIES.length], width: 1.3,
    values: row => take.weights.at(row, region * poses + i) }));
  if (rest.length && rest[0][0] > 1e-4) {
    series.push({ name: `${rest.length} others`, colour: '#59616b', width: 1, values: row => {
      let sum = 0;
      for (const [, i] of rest) sum += take.weights.at(row, region * poses + i);
      return sum;
    } });
  }
  return series;
}

function weightPanel(take, timeline) {
  let region = 0, stacked = false;
  const curve = new Curve(timeline, take.weights, weightSeries(take, 0, 10), { height: 210, digits: 2 });
  const refresh = () => curve.replace(weightSeries(take, region, 10), { stacked });
  const regionButtons = take.regions.map((name, k) => make('button', {
    'aria-pressed': String(k === 0),
    onclick: event => {
      region = k;
      regionButtons.forEach(button => button.setAttribute('aria-pressed', String(button === event.currentTarget)));
      refresh();
    },
  }, make('span', { class: 'dot', style: { background: css(regionColour(Math.max(0, DATA.head.regions.indexOf(name)))) } }), name));
  const stack = make('button', { 'aria-pressed': 'false', onclick: event => {
    stacked = !stacked;
    event.currentTarget.setAttribute('aria-pressed', String(stacked));
    refresh();
  } }, 'Stacked');
  const node = make('div', { class: 'panel' },
    make('h3', {}, 'Pose weights', make('span', { class: 'unit' }, 'the ten largest of the region; what is missing to 1 is neutral')),
    make('div', { class: 'bar' }, make('div', { class: 'pills' }, regionButtons), make('div', { class: 'push' }, stack)), curve.node);
  return { node, curve };
}

function stabilizationPanel(take, timeline) {
  const data = take.stabilization;
  if (!data || !Array.isArray(data.rms_mm) || !data.rms_mm.length) return null;
  const rows = { count: data.rms_mm.length, frame: row => row, row: frame => Math.max(0, Math.min(data.rms_mm.length - 1, frame)) };
  const value = row => typeof data.rms_mm[row] === 'number' ? data.rms_mm[row] : NaN;
  const slips = data.slips || [], bands = () => slips.map(slip => ({ first: slip.frame, last: slip.frame, colour: '#dfa55c' }));
  const curve = new Curve(timeline, rows, [{ name: 'residual', colour: '#5fb8b0', values: value }], { height: 110, bands });
  const notes = slips.map(slip => ` · ${slip.marker} slips by ${fixed(slip.distance_mm)} mm at ${slip.frame}`).join('');
  return { curve, node: make('div', { class: 'panel' },
    make('h3', {}, 'Head stabilization', make('span', { class: 'unit' },
      `mm RMS · ${data.method || ''} · ${fixed(data.rms)} over the take${notes}`)), curve.node) };
}
