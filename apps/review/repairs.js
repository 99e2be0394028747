// What cleaning found wrong with a take and did about it, frame by frame.
const REPAIRS = {
  swap: { glyph: '⇄', name: 'labels swapped back' },
  moved: { glyph: '→', name: 'moved to its label' },
  fragment: { glyph: '+', name: 'unlabelled piece joined' },
  phantom: { glyph: '×', name: 'phantom dropped' },
  spike: { glyph: '▴', name: 'spike removed' },
  marker: { glyph: '=', name: 'frozen marker filled' },
  held: { glyph: '|', name: 'lost frames filled' },
  doubled: { glyph: '|', name: 'doubled frames taken out' },
  refused: { glyph: '○', name: 'change of labels refused' },
  slip: { glyph: '↷', name: 'jig marker slipped' },
};

class RepairPanel {
  constructor(take, jump) {
    this.repairs = take.repairs || [];
    this.jump = jump;
    this.at = -1;
    const counts = Object.keys(REPAIRS).map(kind => [kind, this.repairs.filter(repair => repair.kind === kind).length]);
    this.lines = this.repairs.map((repair, i) => goRow(() => this.go(i), {},
      cell(make('b', { class: 'glyph' }, REPAIRS[repair.kind].glyph)), cell(REPAIRS[repair.kind].name),
      cell(repair.last > repair.first ? `${repair.first}–${repair.last}` : repair.first, true),
      cell(repair.markers.join(', ') || 'all'), cell(repair.what)));
    this.node = make('div', { class: 'panel' }, make('h3', {}, 'Repairs', make('span', { class: 'unit' },
      counts.filter(([, count]) => count).map(([kind, count]) => `${count} × ${REPAIRS[kind].name}`).join(' · ') || 'nothing was wrong'),
    this.repairs.length ? make('span', { class: 'push bar' },
      make('button', { 'aria-label': 'previous repair', onclick: () => this.step(-1) }, '‹'),
      make('button', { 'aria-label': 'next repair', onclick: () => this.step(1) }, '›')) : null),
    this.repairs.length ? make('div', { class: 'scroll short' },
      table([[''], ['What'], ['Frames', true], ['Markers'], ['Change']], this.lines)) : null);
  }

  step(by) { this.go((this.at + by + this.repairs.length) % this.repairs.length); }

  go(index) {
    this.at = index;
    this.lines.forEach((line, i) => line.classList.toggle('chosen', i === index));
    const scroller = this.node.querySelector('.scroll'), line = this.lines[index];
    if (line.offsetTop < scroller.scrollTop + 30 || line.offsetTop + line.offsetHeight > scroller.scrollTop + scroller.clientHeight) {
      scroller.scrollTop = line.offsetTop - scroller.clientHeight / 2;
    }
    this.jump(this.repairs[index]);
  }
}
