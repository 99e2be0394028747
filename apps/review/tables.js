// Tables and lists.
function table(columns, rows) {
  return make('table', {},
    make('thead', {}, make('tr', {}, columns.map(([name, numeric]) => make('th', { class: numeric ? 'n' : null }, name)))),
    make('tbody', {}, rows));
}
const cell = (content, numeric) => make('td', { class: numeric ? 'n' : null }, content);

// A row that acts like a button, with mouse and keyboard.
function goRow(act, attributes, ...cells) {
  return make('tr', Object.assign({ class: 'go', tabindex: 0, onclick: act, onkeydown: event => {
    if (event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    act();
  } }, attributes), cells);
}

function findingsPanel(jump) {
  const findings = DATA.findings || [];
  const item = finding => {
    const where = [finding.take, finding.frame !== undefined ? `frame ${finding.frame}` : null,
      finding.pose ? 'registration' : null].filter(Boolean).join(' · ');
    const canJump = finding.take || finding.pose;
    return make('li', { class: finding.severity }, make('span', {}, finding.text),
      make('span', { class: 'where' }, canJump ? make('a', { href: '#', onclick: event => {
        event.preventDefault();
        jump(finding);
      } }, where) : ''));
  };
  const notable = findings.filter(finding => finding.severity !== 'note'), notes = findings.filter(finding => finding.severity === 'note');
  const shown = notable.slice(0, 8), more = notable.slice(8);
  return make('div', { class: 'panel' },
    notable.length ? make('ul', { class: 'findings' }, shown.map(item))
      : make('div', { class: 'empty' }, 'Nothing stands out: every pose passed, no marker or gap is out of line.'),
    more.length ? make('details', {}, make('summary', {}, `${more.length} more`), make('ul', { class: 'findings' }, more.map(item))) : null,
    notes.length ? make('details', {}, make('summary', {}, plural(notes.length, 'note')), make('ul', { class: 'findings' }, notes.map(item))) : null);
}

function decisionsPanel(title, lists) {
  const lines = lists.flat().filter(line => typeof line === 'string');
  if (!lines.length) return null;
  return make('details', {}, make('summary', {}, `${title} (${lines.length})`), make('ul', {}, lines.map(line => make('li', {}, line))));
}

function liuTable(take) {
  const rows = take.table || [];
  if (!rows.length) return null;
  const used = take.regions ? take.regions.length : -1, largest = Math.max(...rows.map(row => row.mean_mm || 0), 1e-9);
  return make('div', { class: 'panel' },
    make('h3', {}, 'Reconstruction error', make('span', { class: 'unit' },
      `mm, mean of each marker over the take${take.space === 'training' ? ', in the mocap actor’s space' : take.space === 'surface' ? ', on the rig' : ''}`)),
    table([['Solve'], ['Max', true], ['Min', true], ['Mean', true], ['']], rows.map(row =>
      make('tr', { class: row.regions === used ? 'chosen' : null }, cell(row.name), cell(fixed(row.max_mm), true),
        cell(fixed(row.min_mm), true), cell(fixed(row.mean_mm), true),
        make('td', { style: { width: '34%' } }, make('span', { class: 'share' + (row.regions === used ? '' : ' quiet'),
          style: { width: `${100 * (row.mean_mm || 0) / largest}%` } }))))));
}

function markerTable(take, choose) {
  const rows = [...(take.markers || [])].sort((a, b) => (b.mean || 0) - (a.mean || 0));
  if (!rows.length) return null;
  const largest = Math.max(...rows.map(row => row.mean || 0), 1e-9);
  const lines = rows.map(row => goRow(() => choose(row.label), { 'data-marker': row.label },
    cell(row.label), cell(fixed(row.mean), true), cell(fixed(row.p95), true), cell(fixed(row.max), true),
    cell(fixed(row.global), true), cell(percent(row.present), true),
    make('td', { style: { width: '22%' } }, make('span', { class: 'share', style: { width: `${100 * (row.mean || 0) / largest}%` } }))));
  return make('div', { class: 'panel' },
    make('h3', {}, 'Markers', make('span', { class: 'unit' }, 'error in mm; click one to see its curve')),
    make('div', { class: 'scroll' }, table([['Marker'], ['Mean', true], ['95 %', true], ['Max', true], ['Global', true], ['Seen', true], ['']], lines)));
}

function registrationTable(poses, choose) {
  const lines = poses.map(pose => {
    const distance = pose.distance_mm || {}, transferred = pose.source === 'transfer';
    return goRow(() => choose(pose.pose), { 'data-pose': pose.pose },
      cell(pose.pose), cell(make('span', { class: `verdict ${transferred && pose.verdict === 'pass' ? 'given' : pose.verdict || ''}` },
        transferred && pose.verdict === 'pass' ? 'transferred' : pose.verdict || '–')),
      cell(fixed(distance.mean), true), cell(fixed(distance.p95), true), cell(fixed(distance.max), true),
      cell(percent(pose.coverage), true), cell(fixed(pose.landmark_rms_mm), true),
      cell(pose.flipped_triangles === undefined || pose.flipped_triangles === null ? '–' : pose.flipped_triangles, true),
      cell(pose.reason || ''));
  });
  return table([['Pose'], ['Verdict'], ['Mean', true], ['95 %', true], ['Max', true], ['Covered', true], ['Landmarks', true],
    ['Flipped', true], ['Why']], lines);
}

// One registered pose by regions of the face.
function regionTable(pose) {
  const names = ['face', 'forehead', 'eyes', 'nose', 'lips', 'chin', 'under_chin', 'ears', 'neck'].filter(name => (pose.regions || {})[name]);
  if (!names.length) return null;
  return make('details', {}, make('summary', {}, 'By region'), table([['Region'], ['Mean', true], ['95 %', true], ['Covered', true],
    ['Flipped', true], ['Stretched', true], ['Crossing', true], ['Crumpled', true]], names.map(name => {
    const region = pose.regions[name], count = key => cell(region[key] === undefined ? '–' : region[key], true);
    return make('tr', {}, cell(name.replace('_', ' ')), cell(fixed(region.mean), true), cell(fixed(region.p95), true),
      cell(percent(region.coverage), true), count('flipped'), count('stretched'), count('crossing'), count('crumpled'));
  })));
}

// For an actor without a registration report: its poses and what they are called elsewhere.
function poseTable(choose) {
  return table([['Pose'], ['Tags']], DATA.actor.poses.map(pose =>
    goRow(() => choose(pose.name), { 'data-pose': pose.name }, cell(pose.name), cell((pose.tags || []).join(', ')))));
}

function originPanel() {
  const rows = DATA.provenance || [];
  return make('div', { class: 'panel' }, make('details', {}, make('summary', {}, `${plural(rows.length, 'artefact')} and their SHA-256`),
    make('div', { class: 'scroll' }, table([['Artefact'], ['SHA-256']], rows.map(row =>
      make('tr', {}, cell(row.artefact), cell(make('span', { class: 'hash' }, row.sha256))))))));
}
