// The actor's head: geometry of poses and frames, and a three.js view of it.
class HeadModel {
  constructor(json) {
    this.count = json.vertices;
    this.triangles = json.triangles.bytes === 2 ? u16(json.triangles.data) : u32(json.triangles.data);
    const neutral = i16(json.neutral.data);
    this.neutral = new Float32Array(neutral.length);
    for (let i = 0; i < neutral.length; ++i) this.neutral[i] = neutral[i] * json.neutral.step + json.neutral.centre[i % 3];
    this.poses = json.poses.map(pose => ({
      name: pose.name, step: pose.step, vertices: u32(pose.vertices), motion: i16(pose.motion),
    }));
    this.poseIndex = new Map(this.poses.map((pose, i) => [pose.name, i]));
    this.regions = json.regions;
    this.masks = u8(json.masks);
    this.distanceStep = json.distance_step;
    this.distances = new Map(Object.entries(json.distances).map(([pose, data]) => [pose, u16(data)]));
    this.colours = json.colours ? u8(json.colours) : null;
    this.markers = json.markers;
  }

  // Σ_k B_k S̄ w_k (Liu eq. 3) into `out`; weights[region][pose] with the take's names.
  frame(weights, regions, poses, out) {
    out.set(this.neutral);
    const whole = regions.length === 1 && regions[0] === 'whole' || this.regions.length === 0;
    const maskOf = regions.map(name => this.regions.indexOf(name));
    poses.forEach((name, i) => {
      const pose = this.poses[this.poseIndex.get(name)];
      if (!pose || pose.vertices.length === 0) return;
      const active = [];
      regions.forEach((_, k) => {
        if (weights[k][i] > 0.0005 && (whole || maskOf[k] >= 0)) active.push([maskOf[k], weights[k][i]]);
      });
      if (active.length) this.add(pose, active, whole, out);
    });
  }

  add(pose, active, whole, out) {
    const stride = this.regions.length, masks = this.masks;
    for (let n = 0; n < pose.vertices.length; ++n) {
      const v = pose.vertices[n];
      let amount = 0;
      for (const [region, weight] of active) amount += whole ? weight : weight * masks[v * stride + region] / 255;
      if (amount === 0) continue;
      const scale = amount * pose.step;
      out[3 * v] += scale * pose.motion[3 * n];
      out[3 * v + 1] += scale * pose.motion[3 * n + 1];
      out[3 * v + 2] += scale * pose.motion[3 * n + 2];
    }
  }

  pose(name, amount, out) {
    out.set(this.neutral);
    const pose = this.poses[this.poseIndex.get(name)];
    if (pose) this.add(pose, [[0, amount]], true, out);
  }
}

const CLAY = [0.62, 0.58, 0.55];
const DISTANCE_RANGES = [0.25, 0.5, 1, 2, 5];
const MOTION_RANGE = 8;
const VIEW_ANGLE = 24;  // degrees
const DOT_SIZE = 3.4;   // mm; three.js' point size knows nothing of the view angle

class HeadView {
  constructor(model, host) {
    this.model = model;
    this.host = host;
    this.mode = 'clay';
    this.pose = 'neutral';
    this.range = 1;
    this.positions = new Float32Array(model.neutral);
    this.legend = make('div', { class: 'legend' });
    this.build();
    host.append(this.renderer.domElement, this.legend, make('div', { class: 'hint' }, 'drag to turn, wheel to zoom'));
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
    this.colour();
  }

  build() {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(VIEW_ANGLE, 1, 10, 5000);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enablePan = false;
    this.controls.addEventListener('change', () => this.draw());
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(this.model.triangles, 1));
    this.geometry.setAttribute('position', new THREE.BufferAttribute(this.positions, 3));
    this.geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * this.model.count), 3));
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
    const skin = new THREE.MeshStandardMaterial({
      vertexColors: THREE.VertexColors, roughness: 0.62, metalness: 0.0, side: THREE.FrontSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.mesh = new THREE.Mesh(this.geometry, skin);
    this.scene.add(this.mesh);
    this.addLights();
    this.addDots();
    this.frameCamera();
  }

  addLights() {
    this.scene.add(new THREE.HemisphereLight(0xdfe6ee, 0x4a4038, 0.55));
    const light = (colour, strength, x, y, z) => {
      const lamp = new THREE.DirectionalLight(colour, strength);
      lamp.position.set(x, y, z);
      this.scene.add(lamp);
    };
    light(0xfff1e0, 1.35, -0.9, 0.9, 1.2);
    light(0xcfe0f5, 0.35, 1.4, 0.1, 0.7);
    light(0xbfd4ee, 0.5, 0.6, 0.8, -1.4);
  }

  addDots() {
    const markers = this.model.markers;
    if (!markers.length) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * markers.length), 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * markers.length).fill(0.8), 3));
    const disc = make('canvas', { width: 64, height: 64 });
    const paint = disc.getContext('2d');
    paint.fillStyle = '#fff';
    paint.arc(32, 32, 26, 0, 2 * Math.PI);
    paint.fill();
    this.dots = new THREE.Points(geometry, new THREE.PointsMaterial({
      size: DOT_SIZE / Math.tan(VIEW_ANGLE * Math.PI / 360), map: new THREE.CanvasTexture(disc), alphaTest: 0.5, vertexColors: THREE.VertexColors,
    }));
    this.dots.frustumCulled = false;
    this.dots.visible = false;
    this.scene.add(this.dots);
  }

  frameCamera() {
    // The face, not the shoulders: the markers where there are any, else what moves, else everything.
    const box = new THREE.Box3(), point = new THREE.Vector3();
    const add = v => box.expandByPoint(point.fromArray(this.model.neutral, 3 * v));
    this.model.markers.forEach(marker => marker.vertices.forEach(add));
    if (box.isEmpty()) this.model.poses.forEach(pose => { for (const v of pose.vertices) add(v); });
    if (box.isEmpty()) for (let v = 0; v < this.model.count; ++v) add(v);
    const size = box.getSize(new THREE.Vector3()), centre = box.getCenter(new THREE.Vector3());
    const reach = Math.max(size.x, size.y, 120) * 0.86;
    centre.z = box.min.z;
    this.controls.target.copy(centre);
    this.camera.position.set(centre.x + reach * 0.55, centre.y + reach * 0.1, centre.z + reach * 4.0);
    this.controls.minDistance = reach;
    this.controls.maxDistance = reach * 12;
    this.controls.update();
  }

  resize() {
    const width = Math.max(2, this.host.clientWidth), height = Math.max(2, this.host.clientHeight);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  showFrame(take, frame) {
    if (!take.weights) return;
    this.model.frame(take.weightsAt(frame), take.regions, take.poses, this.positions);
    this.moved();
    if (this.dots && this.dots.visible) this.placeDots(take, frame);
  }

  showPose(name) {
    this.pose = name;
    this.model.pose(name, 1, this.positions);
    this.moved();
    if (this.mode === 'distance') this.colour();
  }

  moved() {
    this.geometry.attributes.position.needsUpdate = true;
    this.geometry.computeVertexNormals();
    if (this.mode === 'motion') this.colour();
    this.draw();
  }

  placeDots(take, frame) {
    const where = this.dots.geometry.attributes.position.array, colours = this.dots.geometry.attributes.color.array;
    const normals = this.geometry.attributes.normal.array;
    const row = take.errors ? take.errors.row(frame) : -1;
    this.model.markers.forEach((marker, m) => {
      for (let axis = 0; axis < 3; ++axis) {
        let at = 0;
        marker.vertices.forEach((v, corner) => {
          at += marker.barycentric[corner] * (this.positions[3 * v + axis] + 1.2 * normals[3 * v + axis]);
        });
        where[3 * m + axis] = at;
      }
      const q = take.markerNames.indexOf(marker.label);
      const error = q >= 0 && row >= 0 ? take.errors.at(row, q) : NaN;
      const rgb = q < 0 ? [0.35, 0.37, 0.4] : ramp(error / 3);
      for (let c = 0; c < 3; ++c) colours[3 * m + c] = toLinear(rgb[c]);
    });
    this.dots.geometry.attributes.position.needsUpdate = true;
    this.dots.geometry.attributes.color.needsUpdate = true;
    this.draw();
  }

  setMode(mode) {
    this.mode = mode;
    this.colour();
  }

  colour() {
    const out = this.geometry.attributes.color.array;
    const source = this.colourSource();
    for (let v = 0; v < this.model.count; ++v) {
      const rgb = source(v);
      for (let c = 0; c < 3; ++c) out[3 * v + c] = toLinear(rgb[c]);
    }
    this.geometry.attributes.color.needsUpdate = true;
    this.drawLegend();
    this.draw();
  }

  colourSource() {
    const model = this.model;
    if (this.mode === 'skin' && model.colours) return v => [0, 1, 2].map(c => model.colours[3 * v + c] / 255);
    if (this.mode === 'regions' && model.regions.length) {
      const palette = model.regions.map((_, k) => regionColour(k)), stride = model.regions.length;
      return v => [0, 1, 2].map(c => {
        let sum = 0;
        for (let k = 0; k < stride; ++k) sum += palette[k][c] * model.masks[v * stride + k] / 255;
        return sum;
      });
    }
    if (this.mode === 'distance') {
      const values = model.distances.get(this.pose);
      return v => ramp(!values || values[v] === 65535 ? NaN : values[v] * model.distanceStep / this.range);
    }
    if (this.mode === 'motion') {
      return v => {
        let squared = 0;
        for (let c = 0; c < 3; ++c) squared += (this.positions[3 * v + c] - model.neutral[3 * v + c]) ** 2;
        return ramp(Math.sqrt(squared) / MOTION_RANGE);
      };
    }
    return () => CLAY;
  }

  drawLegend() {
    this.legend.replaceChildren();
    this.legend.hidden = (this.mode === 'clay' || this.mode === 'skin') && !(this.dots && this.dots.visible);
    const scale = (title, last, note) => this.legend.append(
      make('div', {}, title), make('div', { class: 'ramp', style: { background: rampCss() } }),
      make('div', { class: 'ticks' }, make('span', {}, '0'), make('span', {}, `${last} mm or more`)), note || '');
    if (this.mode === 'distance') {
      const known = this.model.distances.has(this.pose);
      scale('Distance to the scan', this.range, make('div', {}, make('span', {
        style: { display: 'inline-block', width: '9px', height: '9px', background: css(NO_VALUE), marginRight: '6px' } }),
        known ? 'no scan beside the mesh' : 'this pose has no scan of its own'));
    } else if (this.mode === 'motion') {
      scale('Motion away from neutral', MOTION_RANGE);
    } else if (this.mode === 'regions') {
      this.legend.append(make('div', { class: 'keys' }, this.model.regions.map((name, k) =>
        make('span', {}, make('i', { style: { background: css(regionColour(k)) } }), name))));
    }
    if (this.dots && this.dots.visible) {
      if (this.legend.childNodes.length) this.legend.append(make('div', { style: { height: '8px' } }));
      scale('Marker error', 3);
    }
  }
}

function modeButtons(view, modes) {
  const names = { clay: 'Clay', skin: 'Skin', regions: 'Regions', motion: 'Motion', distance: 'Scan distance' };
  const buttons = modes.map(mode => make('button', {
    'aria-pressed': String(view.mode === mode),
    onclick: event => {
      view.setMode(mode);
      buttons.forEach(button => button.setAttribute('aria-pressed', String(button === event.currentTarget)));
    },
  }, names[mode]));
  return make('div', { class: 'pills' }, buttons);
}
