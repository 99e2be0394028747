// Puts the page together.
const HEAD = new HeadModel(DATA.head);
const TAKES = (DATA.takes || []).map(take => new Take(take));
const state = { take: null };

function webgl(host, build) {
  try {
    return build();
  } catch (problem) {
    host.replaceChildren(make('div', { class: 'empty', style: { padding: '20px' } }, 'This browser shows no WebGL, so no 3D head.'));
    return null;
  }
}

function fact(value, name) { return make('div', {}, make('b', {}, value), make('span', {}, name)); }

function headerPart() {
  const registration = DATA.registration && DATA.registration.poses || [];
  const scanned = registration.filter(pose => pose.source !== 'transfer');
  const passed = scanned.filter(pose => pose.verdict === 'pass').length;
  const seconds = TAKES.reduce((sum, take) => sum + take.frames / take.rate, 0);
  const regions = TAKES.find(take => take.regions);
  document.getElementById('head').append(
    make('div', { class: 'eyebrow' }, `Vultus ${DATA.version} · session review`),
    make('h1', {}, DATA.actor.name || 'Unnamed actor'),
    make('div', { class: 'facts' },
      fact(TAKES.map(take => take.name).join(', ') || '–', 'takes'),
      fact(`${fixed(seconds, 1)} s`, 'captured'),
      fact(TAKES.length ? `${Math.max(...TAKES.map(take => take.markerNames.length))}` : '–', 'markers'),
      fact(DATA.actor.poses.length, 'poses'),
      fact(regions ? regions.regions.length : '–', regions && regions.regions.length === 1 ? 'region' : 'regions'),
      fact(DATA.session.solver || 'qp', 'solver'),
      fact(DATA.actor.template || '–', `template, ${DATA.actor.vertices.toLocaleString('en')} vertices`),
      scanned.length ? fact(`${passed} of ${scanned.length}`, 'scans passed') : null));
}

function lightbox(pictures, index) {
  const box = document.getElementById('lightbox');
  const show = i => {
    index = (i + pictures.length) % pictures.length;
    const picture = pictures[index];
    box.replaceChildren(make('img', { src: picture.src, alt: `frame ${picture.frame}` }),
      make('p', {}, `${picture.mode} · frame ${picture.frame} · ${picture.width}×${picture.height} · `,
        make('a', { href: picture.href, target: '_blank', onclick: event => event.stopPropagation() }, 'full size file')));
  };
  box.hidden = false;
  box.onclick = () => { box.hidden = true; };
  box.step = delta => show(index + delta);
  show(index);
}

function picturePanel(take, timeline) {
  const all = take.pictures || [], modes = [...new Set(all.map(picture => picture.mode))];
  let mode = modes[0], pictures = all.filter(picture => picture.mode === mode), current = -1;
  const large = make('div', { class: 'picture' }), strip = make('div', { class: 'strip' });
  const caption = make('span', { class: 'unit' });
  const choose = index => {
    if (index === current || !pictures.length) return;
    current = index;
    const picture = pictures[index];
    large.replaceChildren(make('img', { src: picture.src, alt: `rendered frame ${picture.frame}`, onclick: () => lightbox(pictures, current) }));
    caption.textContent = `frame ${picture.frame} · ${picture.width}×${picture.height}`;
    [...strip.children].forEach((button, i) => button.setAttribute('aria-current', String(i === index)));
  };
  const nearest = frame => {
    let best = 0;
    pictures.forEach((picture, i) => { if (Math.abs(picture.frame - frame) < Math.abs(pictures[best].frame - frame)) best = i; });
    choose(best);
  };
  const fill = () => {
    current = -1;
    strip.replaceChildren(...pictures.map((picture, i) => make('button', { title: `frame ${picture.frame}`, onclick: () => {
      timeline.show(picture.frame);
      choose(i);
    } }, make('img', { src: picture.src, alt: '', loading: 'lazy' }))));
    nearest(timeline.frame);
  };
  const modeBar = modes.length > 1 ? make('div', { class: 'pills' }, modes.map(name => make('button', {
    'aria-pressed': String(name === mode),
    onclick: event => {
      mode = name;
      pictures = all.filter(picture => picture.mode === mode);
      [...modeBar.children].forEach(button => button.setAttribute('aria-pressed', String(button === event.currentTarget)));
      fill();
    },
  }, name))) : null;
  const film = take.film ? make('button', { onclick: () => {
    large.replaceChildren(make('video', { src: take.film.src || take.film.href, controls: true, loop: true, autoplay: true, muted: true }));
    caption.textContent = 'film';
    current = -1;
  } }, 'Film') : null;
  timeline.onFrame.push(nearest);
  fill();
  return make('div', { class: 'panel pictures' },
    make('div', { class: 'bar' }, make('h3', { style: { margin: 0 } }, 'Rendered frames', caption), modeBar, film ? make('div', { class: 'push' }, film) : null),
    pictures.length || take.film ? [large, strip]
      : make('div', { class: 'empty' }, 'No rendered frames yet. Make some with: vultus render SESSION --take ' + take.name));
}

function transport(take, timeline) {
  let timer = null;
  const slider = make('input', { type: 'range', min: 0, max: Math.max(0, take.frames - 1), value: 0, 'aria-label': 'frame',
    oninput: event => timeline.show(Number(event.target.value)) });
  const now = make('div', { class: 'now' });
  const play = make('button', {}, 'Play');
  const stop = () => {
    cancelAnimationFrame(timer);
    timer = null;
    play.textContent = 'Play';
  };
  const start = () => {
    const from = timeline.frame >= take.frames - 1 ? 0 : timeline.frame, begun = performance.now();
    play.textContent = 'Pause';
    const tick = () => {
      const frame = from + (performance.now() - begun) / 1000 * take.rate;
      if (frame >= take.frames - 1) {
        timeline.show(take.frames - 1);
        return stop();
      }
      timeline.show(frame);
      timer = requestAnimationFrame(tick);
    };
    timer = requestAnimationFrame(tick);
  };
  play.addEventListener('click', () => timer === null ? start() : stop());
  const write = frame => {
    slider.value = frame;
    now.replaceChildren('frame ', make('b', {}, frame), ` · ${fixed(take.seconds(frame), 2)} s`);
  };
  timeline.onFrame.push(write);
  write(0);
  return { node: make('div', { class: 'transport' }, play, slider, now), toggle: () => play.click(), stop };
}

function facePanel(take, timeline) {
  const host = make('div', { class: 'view' }), bar = make('div', { class: 'bar' }, make('h3', { style: { margin: 0 } }, 'Performance'));
  const controls = transport(take, timeline);
  const node = make('div', { class: 'panel' }, bar, host, controls.node);
  const mount = () => {
    const view = webgl(host, () => new HeadView(HEAD, host));
    if (!view) return;
    const modes = ['clay', HEAD.colours ? 'skin' : null, HEAD.regions.length ? 'regions' : null, 'motion'].filter(Boolean);
    const dots = view.dots ? make('button', { 'aria-pressed': 'true', onclick: event => {
      view.dots.visible = !view.dots.visible;
      event.currentTarget.setAttribute('aria-pressed', String(view.dots.visible));
      view.showFrame(take, timeline.frame);
      view.drawLegend();
      view.draw();
    } }, 'Markers') : null;
    if (view.dots) view.dots.visible = true;
    bar.append(modeButtons(view, modes), ...(dots ? [make('div', { class: 'push' }, dots)] : []));
    view.drawLegend();
    view.showFrame(take, timeline.frame);
    timeline.onFrame.push(frame => view.showFrame(take, frame));
  };
  return { node, mount, controls };
}

function errorPanel(take, timeline) {
  const curve = new Curve(timeline, take.errors, errorSeries(take, ''), { height: 210 });
  const node = make('div', { class: 'panel' },
    make('h3', {}, 'Marker error', make('span', { class: 'unit' }, 'mm; drag to zoom, double-click for all, click to go to a frame')), curve.node);
  return { node, curve, choose: marker => curve.replace(errorSeries(take, marker), {}) };
}

function takePart(take, body) {
  if (state.controls) state.controls.stop();
  body.replaceChildren();
  const timeline = new Timeline(take), mounts = [];
  const face = facePanel(take, timeline);
  body.append(make('div', { class: 'grid stage' }, face.node, picturePanel(take, timeline)));
  mounts.push(face.mount);
  const charts = make('div', { class: 'grid', style: { marginTop: '14px' } });
  const gaps = new GapChart(take, timeline, marker => chooseMarker(marker));
  let errors = null, cleaning = null;
  const chooseMarker = marker => {
    gaps.show(marker);
    if (cleaning) cleaning.choose(marker);
    if (!errors) return;
    errors.choose(marker);
    body.querySelectorAll('tr[data-marker]').forEach(row => row.classList.toggle('chosen', row.dataset.marker === marker));
  };
  if (take.errors) {
    errors = errorPanel(take, timeline);
    charts.append(errors.node);
    mounts.push(() => errors.curve.mount());
  }
  if (take.weights) {
    const weights = weightPanel(take, timeline);
    charts.append(weights.node);
    mounts.push(() => weights.curve.mount());
  }
  charts.append(gaps.node);
  mounts.push(() => gaps.mount());
  if (take.repairs) {
    charts.append(new RepairPanel(take, repair => {
      if (repair.markers.length) chooseMarker(repair.markers[0]);
      timeline.show(repair.first);
    }).node);
  }
  const steady = stabilizationPanel(take, timeline);
  if (steady) {
    charts.append(steady.node);
    mounts.push(() => steady.curve.mount());
  }
  if (take.curves) {
    cleaning = new CleaningPanel(take, timeline);
    charts.append(cleaning.node);
    mounts.push(() => cleaning.mount());
  }
  const left = make('div', { class: 'grid' }, liuTable(take), decisionsPart(take));
  charts.append(make('div', { class: 'grid figures' }, left, markerTable(take, chooseMarker)));
  body.append(charts);
  mounts.forEach(mount => mount());
  Object.assign(state, { take, timeline, controls: face.controls, chooseMarker });
  if (take.pictures && take.pictures.length) timeline.show(take.pictures[0].frame);
}

function decisionsPart(take) {
  const node = make('div', { class: 'panel' }, make('h3', {}, 'What was decided'));
  const shared = DATA.session.decisions || [], own = (take.decisions || []).filter(line => !shared.includes(line));
  const parts = [decisionsPanel('This take', [own]), decisionsPanel('The session', [shared])].filter(Boolean);
  const residual = (take.solve || {}).worst_kkt_residual, known = typeof residual === 'number';
  if (known) {
    node.append(make('div', { class: 'unit', style: { marginBottom: '6px' } }, `KKT residual ${residual.toExponential(1)}`));
  }
  node.append(...parts);
  if (parts.length === 1) parts[0].open = true;
  return parts.length || known ? node : null;
}

function takesPart() {
  const section = document.getElementById('takes');
  if (!TAKES.length) {
    section.append(make('h2', {}, 'Takes'), make('div', { class: 'panel empty' }, 'This session has no take yet.'));
    return () => {};
  }
  const body = make('div', {});
  const facts = make('span', { class: 'unit' });
  const tabs = TAKES.map(take => make('button', { onclick: () => open(take) }, take.name));
  const open = take => {
    tabs.forEach((tab, i) => tab.setAttribute('aria-pressed', String(TAKES[i] === take)));
    facts.textContent = `${take.frames.toLocaleString('en')} frames at ${fixed(take.rate, take.rate % 1 ? 2 : 0)} Hz, ` +
      `${fixed(take.frames / take.rate, 1)} s, ${plural(take.markerNames.length, 'marker')}`;
    if (state.take !== take) takePart(take, body);
  };
  section.append(make('h2', {}, 'Takes'), make('div', { class: 'bar' }, make('div', { class: 'pills' }, tabs), facts), body);
  open(TAKES[0]);
  return open;
}

function registrationPart() {
  const section = document.getElementById('registration'), poses = DATA.registration && DATA.registration.poses || [];
  const names = poses.length ? poses.map(pose => pose.pose) : HEAD.poses.map(pose => pose.name);
  const host = make('div', { class: 'view' }), bar = make('div', { class: 'bar' }), picture = make('div', {});
  const select = make('select', { 'aria-label': 'pose', onchange: event => choose(event.target.value) },
    names.map(name => make('option', { value: name }, name)));
  const registration = DATA.registration || {};
  section.append(make('h2', {}, 'Actor'), make('div', { class: 'grid stage' },
    make('div', { class: 'panel' }, bar, host, picture),
    make('div', { class: 'panel' }, make('h3', {}, poses.length ? 'Registration' : 'Poses', make('span', { class: 'unit' },
      poses.length ? `distances in mm${registration.method ? ' · method ' + registration.method : ''}`
        : 'this actor has no registration report')),
    make('div', { class: 'scroll tall' }, poses.length ? registrationTable(poses, name => choose(name)) : poseTable(name => choose(name))),
    decisionsPanel('Decisions', [registration.decisions || []]))));
  const view = webgl(host, () => new HeadView(HEAD, host));
  const choose = name => {
    select.value = name;
    if (view) view.showPose(name);
    section.querySelectorAll('tr[data-pose]').forEach(row => row.classList.toggle('chosen', row.dataset.pose === name));
    const entry = poses.find(pose => pose.pose === name);
    picture.replaceChildren(...(entry ? [entry.picture ? make('img', { src: entry.picture.src, alt: `registration of ${name}`,
      style: { width: '100%', marginTop: '10px', borderRadius: '4px' } }) : '',
    entry.picture && entry.regions ? make('div', { class: 'empty', style: { padding: '4px 0' } },
      'scan as cleaned (removed red, invented blue) · result · distance to the scan, dark from 1 mm · the whole scan') : '',
    regionTable(entry) || '', decisionsPanel('What was removed and repaired', [entry.cleaning || []]) || ''] : []));
  };
  if (view) {
    const measured = HEAD.distances.size > 0;
    view.setMode(measured ? 'distance' : HEAD.regions.length ? 'regions' : 'clay');
    const modes = [measured ? 'distance' : null, 'motion', 'clay', HEAD.colours ? 'skin' : null, HEAD.regions.length ? 'regions' : null].filter(Boolean);
    const range = make('select', { 'aria-label': 'range', onchange: event => {
      view.range = Number(event.target.value);
      view.colour();
    } }, DISTANCE_RANGES.map(mm => make('option', { value: mm, selected: mm === view.range }, `to ${mm} mm`)));
    bar.append(select, modeButtons(view, modes), ...(measured ? [make('div', { class: 'push' }, range)] : []));
  }
  choose(names[0]);
  return choose;
}

function keys(event) {
  const box = document.getElementById('lightbox');
  if (!box.hidden) {
    if (event.key === 'Escape') box.hidden = true;
    if (event.key === 'ArrowLeft') box.step(-1);
    if (event.key === 'ArrowRight') box.step(1);
    return;
  }
  if (event.defaultPrevented || /^(INPUT|SELECT|TEXTAREA|BUTTON)$/.test(event.target.tagName) || !state.timeline) return;
  if (event.key === ' ') state.controls.toggle();
  else if (event.key === 'ArrowLeft') state.timeline.show(state.timeline.frame - 1);
  else if (event.key === 'ArrowRight') state.timeline.show(state.timeline.frame + 1);
  else return;
  event.preventDefault();
}

// A link may name the take, marker and frame to open at: index.html#take=NAME&marker=LABEL&frame=120
function openLinked() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const take = TAKES.find(candidate => candidate.name === wanted.get('take'));
  if (take) openTake(take);
  if (wanted.has('marker') && state.chooseMarker) state.chooseMarker(wanted.get('marker'));
  if (wanted.has('frame') && state.timeline) state.timeline.show(Number(wanted.get('frame')) || 0);
}

headerPart();
const openTake = takesPart();
const openPose = registrationPart();
document.getElementById('look').append(make('h2', {}, 'Where to look'), findingsPanel(finding => {
  if (finding.pose) {
    openPose(finding.pose);
    document.getElementById('registration').scrollIntoView({ behavior: 'smooth' });
    return;
  }
  openTake(TAKES.find(take => take.name === finding.take));
  if (finding.marker) state.chooseMarker(finding.marker);
  if (finding.frame !== undefined) state.timeline.show(finding.frame);
  document.getElementById('takes').scrollIntoView({ behavior: 'smooth' });
}));
document.getElementById('origin').append(make('h2', {}, 'Provenance'), originPanel(),
  make('footer', {}, `Vultus ${DATA.version} · curves by dygraphs, head by three.js`));
document.addEventListener('keydown', keys);
window.addEventListener('hashchange', openLinked);
openLinked();
