// Marker × time: where samples were filled, how, and how sure that is; where something was repaired.
const GAP_ROW = 13, GAP_TOP = 4, GAP_FOOT = 20;

const GAP_ORDERS = {
  'as in the take': null,
  'most missing first': gaps => -gaps.reduce((sum, gap) => sum + gap.last - gap.first + 1, 0),
  'least certain first': gaps => -Math.max(0, ...gaps.map(gap => gap.method === 'missing' ? Infinity : gap.expected_error_mm || 0)),
  'repaired first': (gaps, marks) => -marks.length,
};

class GapChart {
  constructor(take, timeline, choose) {
    this.take = take;
    this.timeline = timeline;
    this.choose = choose;
    this.gaps = groups(take.gaps || [], gap => gap.marker);
    const marks = (take.repairs || []).flatMap(repair => repair.marks.map(([marker, first, last]) => ({ marker, first, last, repair })));
    this.marks = groups(marks, mark => mark.marker);
    const known = take.markerNames, seen = new Set([...this.gaps.keys(), ...this.marks.keys()]);
    this.rows = [...known.filter(label => seen.has(label)), ...[...seen].filter(label => !known.includes(label)).sort()];
    this.inOrder = this.rows.slice();
    this.whole = known.filter(label => !seen.has(label)).length;
    this.build();
  }

  build() {
    this.canvas = make('canvas', { tabindex: 0, role: 'img', 'aria-label':
      'gaps and repairs of each marker over time; up and down choose a marker, left and right a frame' });
    this.axis = make('canvas', { 'aria-hidden': 'true' });
    this.tip = make('div', { class: 'tip', hidden: true });
    this.box = make('div', { class: 'gapchart' }, this.canvas, this.tip);
    this.outer = make('div', {}, make('div', { class: 'scroll gaprows' }, this.box), this.axis);
    this.canvas.addEventListener('mousemove', event => this.hover(event));
    this.canvas.addEventListener('mouseleave', () => { this.tip.hidden = true; });
    this.canvas.addEventListener('click', event => this.click(event));
    this.canvas.addEventListener('keydown', event => this.key(event));
    this.timeline.onFrame.push(() => this.draw());
    this.timeline.onWindow.push(() => this.draw());
    this.node = make('div', { class: 'panel' }, this.title(), this.rows.length ? this.outer
      : make('div', { class: 'empty' }, this.take.gaps ? 'Every marker was seen in every frame.' : 'No record of filled samples.'));
  }

  title() {
    const gaps = [...this.gaps.values()].flat(), methods = Object.keys(GAP_NAMES).filter(name => gaps.some(gap => gap.method === name));
    const drawn = (this.take.repairs || []).filter(repair => repair.marks.length || !repair.markers.length);
    const kinds = Object.keys(REPAIRS).filter(kind => drawn.some(repair => repair.kind === kind));
    const order = make('select', { 'aria-label': 'order of the markers', onchange: event => this.sort(event.target.value) },
      Object.keys(GAP_ORDERS).map(name => make('option', { value: name }, name)));
    return make('h3', {}, 'Gaps and repairs', make('span', { class: 'unit' }, gaps.length
      ? `${plural(gaps.length, 'gap')} in ${plural(this.gaps.size, 'marker')}` + (this.whole ? `, ${this.whole} without` : '') +
        ' · fainter is less certain' : ''),
    make('span', { class: 'chips' },
      methods.map(method => make('span', {}, swatch(method), GAP_NAMES[method], make('b', {}, gaps.filter(gap => gap.method === method).length))),
      kinds.map(kind => make('span', {}, make('b', { class: 'glyph' }, REPAIRS[kind].glyph), REPAIRS[kind].name))),
    this.rows.length > 1 ? make('span', { class: 'push' }, order) : null);
  }

  sort(name) {
    const key = GAP_ORDERS[name];
    this.rows = this.inOrder.slice();
    if (key) {
      const keys = new Map(this.rows.map(label => [label, key(this.gaps.get(label) || [], this.marks.get(label) || [])]));
      this.rows.sort((a, b) => keys.get(a) === keys.get(b) ? 0 : keys.get(a) - keys.get(b));
    }
    this.draw();
  }

  mount() {
    if (!this.rows.length) return;
    new ResizeObserver(() => this.draw()).observe(this.outer);
    this.draw();
  }

  // The chosen marker's row, brought into view.
  show(label) {
    this.chosen = label;
    const at = this.rows.indexOf(label), scroller = this.box.parentNode, y = GAP_TOP + at * GAP_ROW;
    if (at >= 0 && (y < scroller.scrollTop || y + GAP_ROW > scroller.scrollTop + scroller.clientHeight)) {
      scroller.scrollTop = y - scroller.clientHeight / 2;
    }
    this.draw();
  }

  // As wide as the plots above, whether or not a scroll bar covers the edge.
  scale() {
    const [first, last] = this.timeline.window, total = this.outer.clientWidth, width = total - PLOT_LEFT - PLOT_RIGHT;
    const perFrame = width / Math.max(1e-9, last - first);
    return { total, width, x: frame => PLOT_LEFT + (frame - first) * perFrame, frame: x => first + (x - PLOT_LEFT) / perFrame };
  }

  draw() {
    const scale = this.scale();
    if (scale.total < 10 || !this.rows.length) return;
    const height = GAP_TOP + this.rows.length * GAP_ROW, paint = sized(this.canvas, scale.total, height);
    this.rows.forEach((label, n) => this.drawLabel(paint, label, GAP_TOP + n * GAP_ROW, scale));
    paint.save();
    paint.beginPath();
    paint.rect(PLOT_LEFT, 0, scale.width, height);
    paint.clip();
    this.rows.forEach((label, n) => this.drawRow(paint, label, GAP_TOP + n * GAP_ROW, scale));
    this.drawWholeFrames(paint, height, scale);
    paint.fillStyle = 'rgba(242, 243, 245, 0.7)';
    paint.fillRect(scale.x(this.timeline.frame), 0, 1, height);
    paint.restore();
    this.drawTicks(scale);
  }

  drawLabel(paint, label, y, scale) {
    const chosen = label === this.chosen;
    paint.fillStyle = chosen ? '#33302a' : '#22262b';
    paint.fillRect(PLOT_LEFT, y + 2, scale.width, GAP_ROW - 4);
    paint.fillStyle = chosen ? '#f0d3a8' : '#9aa1aa';
    paint.textAlign = 'right';
    paint.fillText(label.length > 20 ? label.slice(0, 19) + '…' : label, PLOT_LEFT - 8, y + GAP_ROW / 2);
  }

  drawRow(paint, label, y, scale) {
    for (const gap of this.gaps.get(label) || []) {
      const left = scale.x(gap.first), wide = Math.max(1.5, scale.x(gap.last + 1) - left);
      paintGap(paint, gap.method, left, y + 2, wide, GAP_ROW - 4, 1 - (gap.expected_error_mm || 0) / 4);
    }
    paint.fillStyle = '#f2f3f5';
    paint.textAlign = 'right';
    for (const { first, last, repair } of this.marks.get(label) || []) {
      const left = scale.x(first);
      paint.fillRect(left, y + GAP_ROW - 3, Math.max(2, scale.x(last + 1) - left), 1.5);
      paint.fillText(REPAIRS[repair.kind].glyph, left - 1, y + GAP_ROW / 2);
    }
  }

  // Frames that were lost or put in as a whole.
  drawWholeFrames(paint, height, scale) {
    paint.fillStyle = 'rgba(242, 243, 245, 0.16)';
    for (const repair of this.take.repairs || []) {
      if (repair.markers.length) continue;
      const left = scale.x(repair.first);
      paint.fillRect(left, 0, Math.max(1.5, scale.x(repair.last + 1) - left), height);
    }
  }

  drawTicks(scale) {
    const paint = sized(this.axis, scale.total, GAP_FOOT), [first, last] = this.timeline.window, rough = (last - first) / 10;
    const power = Math.pow(10, Math.floor(Math.log10(Math.max(rough, 1))));
    const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough) || power;
    paint.fillStyle = '#8d949d';
    paint.textAlign = 'center';
    for (let frame = Math.ceil(first / step) * step; frame <= last; frame += step) {
      paint.fillText(String(frame), scale.x(frame), GAP_FOOT / 2);
    }
  }

  rowAt(event) { return this.rows[Math.floor((event.offsetY - GAP_TOP) / GAP_ROW)]; }

  click(event) {
    const label = this.rowAt(event);
    if (event.offsetX >= PLOT_LEFT) this.timeline.show(this.scale().frame(event.offsetX));
    if (label) this.choose(label);
  }

  key(event) {
    const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!step) return;
    const at = this.rows.indexOf(this.chosen);
    this.choose(this.rows[Math.max(0, Math.min(this.rows.length - 1, at < 0 ? 0 : at + step))]);
    event.preventDefault();
  }

  hover(event) {
    const frame = this.scale().frame(event.offsetX), label = this.rowAt(event);
    const near = list => (list || []).filter(item => frame >= item.first - 1 && frame <= item.last + 1);
    const gap = near(this.gaps.get(label))[0];
    const lines = near(this.marks.get(label)).map(mark => `${REPAIRS[mark.repair.kind].name}: ${mark.repair.what}`);
    if (gap) {
      lines.unshift(`frames ${gap.first}–${gap.last} (${fixed((gap.last - gap.first + 1) / this.take.rate, 2)} s) · ${GAP_NAMES[gap.method] || gap.method}` +
        (gap.method === 'missing' ? '' : ` · ±${fixed(gap.expected_error_mm, 2)} mm expected`));
    }
    this.tip.hidden = !lines.length;
    if (!lines.length) return;
    this.tip.textContent = `${label} · ${lines.join('\n')}`;
    this.tip.style.left = `${Math.max(0, Math.min(event.offsetX + 12, this.outer.clientWidth - this.tip.offsetWidth - 8))}px`;
    this.tip.style.top = `${event.offsetY + 14}px`;
  }
}

// A canvas of so many CSS pixels, ready for small text.
function sized(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1, paint = canvas.getContext('2d');
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  paint.setTransform(ratio, 0, 0, ratio, 0, 0);
  paint.font = '11px "DejaVu Sans", sans-serif';
  paint.textBaseline = 'middle';
  return paint;
}

// A hole is an outline with strokes across, so that it does not rest on colour alone.
function paintGap(paint, method, x, y, width, height, certainty) {
  paint.fillStyle = paint.strokeStyle = GAP_COLOURS[method] || '#888888';
  if (method !== 'missing') {
    paint.globalAlpha = Math.max(0.35, certainty);
    paint.fillRect(x, y, width, height);
    paint.globalAlpha = 1;
    return;
  }
  paint.save();
  paint.beginPath();
  paint.rect(x, y, width, height);
  paint.clip();
  for (let at = x - height; at < x + width; at += 4) {
    paint.moveTo(at, y + height);
    paint.lineTo(at + height, y);
  }
  paint.rect(x, y, width, height);
  paint.stroke();
  paint.restore();
}

function swatch(method) {
  const canvas = make('canvas', { class: 'swatch' });
  paintGap(sized(canvas, 14, 9), method, 0, 0, 14, 9, 1);
  return canvas;
}
