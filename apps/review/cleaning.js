// One marker before and after cleaning: three axes, in the head's frame, under the same timeline as everything else.
const AXIS_NAMES = ['x · to the subject\'s left', 'y · up', 'z · forward'];

class CleaningPanel {
  constructor(take, timeline) {
    this.take = take;
    this.labels = take.curves.labels;
    this.before = new Rows(take.curves.measured);
    this.after = new Rows(take.curves.clean);
    this.expected = take.curves.expected ? new Rows(take.curves.expected) : null;
    this.marker = this.busiest();
    this.curves = AXIS_NAMES.map((name, axis) => new Curve(timeline, this.after, this.series(axis), {
      height: 120, digits: 2, valueRange: [null, null],
      bars: true, bands: () => this.bands() }));
    this.select = make('select', { 'aria-label': 'marker', onchange: event => this.choose(event.target.value) },
      this.labels.map(label => make('option', { value: label, selected: label === this.labels[this.marker] }, label)));
    this.about = make('span', { class: 'unit' });
    const step = by => this.choose(this.labels[(this.marker + by + this.labels.length) % this.labels.length]);
    this.node = make('div', { class: 'panel' },
      make('h3', {}, 'Before and after', make('span', { class: 'unit' },
        'mm in the head\'s frame · grey: as measured, under its repaired label · orange: cleaned, alone where the sample was made, ' +
        'with its expected error · lighter ground: repaired')),
      make('div', { class: 'bar' }, make('button', { 'aria-label': 'previous marker', onclick: () => step(-1) }, '‹'), this.select,
        make('button', { 'aria-label': 'next marker', onclick: () => step(1) }, '›'), this.about),
      this.curves.map((curve, axis) => make('div', {}, make('div', { class: 'unit' }, AXIS_NAMES[axis]), curve.node)));
    this.describe();
  }

  // The marker with most samples missing that was seen at all: there is most to look at.
  busiest() {
    const lost = label => (this.take.gaps || []).filter(gap => gap.marker === label)
      .reduce((sum, gap) => sum + gap.last - gap.first + 1, 0);
    const counts = this.labels.map(lost).map(count => count < 0.7 * this.take.frames ? count : -1);
    return counts.indexOf(Math.max(...counts));
  }

  value(rows, row, axis) {
    const column = 3 * this.marker + axis;
    return row < rows.count ? rows.at(row, column) + this.take.curves.least[column] : NaN;
  }

  // Where the chosen marker was repaired.
  bands() {
    const label = this.labels[this.marker];
    return (this.take.repairs || []).flatMap(repair => repair.marks.filter(mark => mark[0] === label)
      .map(([, first, last]) => ({ first, last, colour: '#2d333b' })));
  }

  // Expected error of a sample that was made, mm.
  error(row) {
    if (!this.expected) return 0;
    return this.expected.at(this.expected.row(this.after.frame(row)), this.marker);
  }

  series(axis) {
    return [{ name: 'measured', colour: '#7d8590', width: 4, values: row => this.value(this.before, row, axis) },
      { name: 'cleaned', colour: '#e0a458', width: 1.3, values: row => this.value(this.after, row, axis),
        spread: row => this.error(row) }];
  }

  describe() {
    const label = this.labels[this.marker], gaps = (this.take.gaps || []).filter(gap => gap.marker === label);
    const repairs = (this.take.repairs || []).filter(repair => repair.kind !== 'refused' && repair.markers.includes(label));
    this.about.textContent = [plural(gaps.length, 'gap'), plural(repairs.length, 'repair'),
      this.after.stride > 1 ? `every ${this.after.stride}th frame` : ''].filter(Boolean).join(' · ');
  }

  choose(label) {
    const index = this.labels.indexOf(label);
    if (index < 0) return;
    this.marker = index;
    this.select.value = label;
    this.describe();
    this.curves.forEach((curve, axis) => curve.replace(this.series(axis), {}));
  }

  mount() { this.curves.forEach(curve => curve.mount()); }
}
