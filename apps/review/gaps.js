// Marker × time: where samples were filled, how, and how sure that is.
const GAP_ROW = 13, GAP_TOP = 4, GAP_FOOT = 20;

class GapChart {
  constructor(take, timeline) {
    this.take = take;
    this.timeline = timeline;
    this.gaps = take.gaps || [];
    const known = take.markerNames.length ? take.markerNames : [];
    const labels = new Set(this.gaps.map(gap => gap.marker));
    this.rows = [...known.filter(label => labels.has(label)), ...[...labels].filter(label => !known.includes(label)).sort()];
    this.whole = known.filter(label => !labels.has(label)).length;
    this.canvas = make('canvas', {});
    this.tip = make('div', { class: 'tip', hidden: true });
    this.box = make('div', { class: 'gapchart' }, this.canvas, this.tip);
    this.canvas.addEventListener('mousemove', event => this.hover(event));
    this.canvas.addEventListener('mouseleave', () => { this.tip.hidden = true; });
    this.canvas.addEventListener('click', event => timeline.show(this.frameAt(event.offsetX)));
    timeline.onFrame.push(() => this.draw());
    timeline.onWindow.push(() => this.draw());
    this.node = make('div', { class: 'panel' }, this.title(), this.rows.length
      ? make('div', { class: 'scroll' }, this.box)
      : make('div', { class: 'empty' }, take.gaps ? 'Every marker was seen in every frame.' : 'No record of filled samples.'));
  }

  title() {
    const methods = [...new Set(this.gaps.map(gap => gap.method))];
    const counts = method => this.gaps.filter(gap => gap.method === method).length;
    return make('h3', {}, 'Gaps', make('span', { class: 'unit' },
      this.gaps.length ? `${plural(this.gaps.length, 'gap')} in ${plural(this.rows.length, 'marker')}` +
        (this.whole ? `, ${this.whole} without` : '') + ' · fainter is less certain' : ''),
    make('span', { class: 'chips' }, methods.map(method => make('span', {},
      make('i', { style: { background: GAP_COLOURS[method] || '#888', height: '8px' } }), `${GAP_NAMES[method] || method} ${counts(method)}`))));
  }

  mount() {
    if (!this.rows.length) return;
    new ResizeObserver(() => this.draw()).observe(this.box);
    this.draw();
  }

  scale() {
    const [first, last] = this.timeline.window, width = this.box.clientWidth - PLOT_LEFT - PLOT_RIGHT;
    return { first, perFrame: width / Math.max(1e-9, last - first) };
  }

  frameAt(x) {
    const { first, perFrame } = this.scale();
    return first + (x - PLOT_LEFT) / perFrame;
  }

  draw() {
    const width = this.box.clientWidth, height = GAP_TOP + this.rows.length * GAP_ROW + GAP_FOOT;
    if (width < 10) return;
    const ratio = window.devicePixelRatio || 1, paint = this.canvas.getContext('2d');
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.canvas.style.height = `${height}px`;
    paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { first, perFrame } = this.scale(), x = frame => PLOT_LEFT + (frame - first) * perFrame;
    paint.font = '11px "DejaVu Sans", sans-serif';
    paint.textBaseline = 'middle';
    this.rows.forEach((label, n) => {
      const y = GAP_TOP + n * GAP_ROW;
      paint.fillStyle = '#22262b';
      paint.fillRect(PLOT_LEFT, y + 2, width - PLOT_LEFT - PLOT_RIGHT, GAP_ROW - 4);
      paint.fillStyle = '#9aa1aa';
      paint.textAlign = 'right';
      paint.fillText(label.length > 20 ? label.slice(0, 19) + '…' : label, PLOT_LEFT - 8, y + GAP_ROW / 2);
    });
    paint.save();
    paint.beginPath();
    paint.rect(PLOT_LEFT, 0, width - PLOT_LEFT - PLOT_RIGHT, height);
    paint.clip();
    for (const gap of this.gaps) {
      const y = GAP_TOP + this.rows.indexOf(gap.marker) * GAP_ROW, left = x(gap.first), wide = Math.max(1.5, x(gap.last + 1) - left);
      paint.globalAlpha = gap.method === 'missing' ? 1 : Math.max(0.35, 1 - (gap.expected_error_mm || 0) / 4);
      paint.fillStyle = GAP_COLOURS[gap.method] || '#888888';
      paint.fillRect(left, y + 2, wide, GAP_ROW - 4);
    }
    paint.globalAlpha = 0.7;
    paint.fillStyle = '#f2f3f5';
    paint.fillRect(x(this.timeline.frame), 0, 1, height - GAP_FOOT);
    paint.restore();
    this.drawTicks(paint, x, width, height);
  }

  drawTicks(paint, x, width, height) {
    const [first, last] = this.timeline.window, rough = (last - first) / 8;
    const power = Math.pow(10, Math.floor(Math.log10(Math.max(rough, 1))));
    const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough) || power;
    paint.globalAlpha = 1;
    paint.fillStyle = '#8d949d';
    paint.textAlign = 'center';
    for (let frame = Math.ceil(first / step) * step; frame <= last; frame += step) {
      paint.fillText(String(frame), x(frame), height - GAP_FOOT / 2);
    }
  }

  hover(event) {
    const frame = this.frameAt(event.offsetX), label = this.rows[Math.floor((event.offsetY - GAP_TOP) / GAP_ROW)];
    const gap = this.gaps.find(g => g.marker === label && frame >= g.first - 1 && frame <= g.last + 1);
    this.tip.hidden = !gap;
    if (!gap) return;
    const length = gap.last - gap.first + 1;
    this.tip.textContent = `${gap.marker} · frames ${gap.first}–${gap.last} (${fixed(length / this.take.rate, 2)} s) · ` +
      `${GAP_NAMES[gap.method] || gap.method}` + (gap.method === 'missing' ? '' : ` · ±${fixed(gap.expected_error_mm, 2)} mm expected`);
    this.tip.style.left = `${Math.min(event.offsetX + 12, this.box.clientWidth - this.tip.offsetWidth - 8)}px`;
    this.tip.style.top = `${event.offsetY + 14}px`;
  }
}
