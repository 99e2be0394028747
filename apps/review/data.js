'use strict';
// The page's data: JSON with base64 arrays, little-endian.
const DATA = JSON.parse(document.getElementById('data').textContent);

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
const u8 = base64 => bytesOf(base64);
const u16 = base64 => new Uint16Array(bytesOf(base64).buffer);
const i16 = base64 => new Int16Array(bytesOf(base64).buffer);
const u32 = base64 => new Uint32Array(bytesOf(base64).buffer);

// Rows of quantized values, one row for every `stride` frames; 65535 is "no value".
class Rows {
  constructor(json) {
    this.stride = json.stride;
    this.width = json.width;
    this.step = json.step;
    this.values = u16(json.data);
    this.count = this.values.length / this.width;
  }
  at(row, column) {
    const value = this.values[row * this.width + column];
    return value === 65535 ? NaN : value * this.step;
  }
  frame(row) { return row * this.stride; }
  row(frame) { return Math.max(0, Math.min(this.count - 1, Math.round(frame / this.stride))); }
}

// A take with its arrays decoded on first use.
class Take {
  constructor(json) {
    Object.assign(this, json);
    this.json = json;
    this.frames = json.frames || 0;
    this.rate = json.rate_hz > 0 ? json.rate_hz : 60;
    this.weights = json.weights ? new Rows(json.weights) : null;
    this.errors = json.errors ? new Rows(json.errors) : null;
    this.globalMeans = json.global_means ? new Rows(json.global_means) : null;
    this.markerNames = (json.markers || []).map(marker => marker.label);
  }
  seconds(frame) { return frame / this.rate; }
  // weights[region][pose] of a frame.
  weightsAt(frame) {
    const row = this.weights.row(frame), poses = this.poses.length;
    return this.regions.map((_, k) => this.poses.map((_, i) => this.weights.at(row, k * poses + i)));
  }
  // Mean and largest marker error of a stored row, mm.
  errorFigures(row) {
    let sum = 0, count = 0, worst = NaN;
    for (let q = 0; q < this.errors.width; ++q) {
      const error = this.errors.at(row, q);
      if (isNaN(error)) continue;
      sum += error;
      ++count;
      if (!(error <= worst)) worst = error;
    }
    return { mean: count ? sum / count : NaN, worst };
  }
}

// The frame shown and the range the curves show, shared by everything that belongs to a take.
class Timeline {
  constructor(take) {
    this.take = take;
    this.frame = 0;
    this.window = [0, Math.max(1, take.frames - 1)];
    this.onFrame = [];
    this.onWindow = [];
  }
  show(frame) {
    const clamped = Math.max(0, Math.min(this.take.frames - 1, Math.round(frame)));
    if (clamped === this.frame) return;
    this.frame = clamped;
    this.onFrame.forEach(call => call(clamped));
  }
  range(first, last, source) {
    if (this.window[0] === first && this.window[1] === last) return;
    this.window = [first, last];
    this.onWindow.forEach(call => call(first, last, source));
  }
}

// Small DOM builder: make('td', {class: 'n'}, 'text', node…).
function make(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (name === 'style') Object.assign(node.style, value);
    else node.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat()) {
    if (child === null || child === undefined) continue;
    node.append(child instanceof Node ? child : String(child));
  }
  return node;
}

const fixed = (value, digits = 2) => typeof value === 'number' && isFinite(value) ? value.toFixed(digits) : '–';
const percent = value => typeof value === 'number' && isFinite(value) ? (100 * value).toFixed(0) + ' %' : '–';
const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
// A list by what `key` says of its items.
function groups(items, key) {
  const result = new Map();
  for (const item of items) {
    const name = key(item);
    if (!result.has(name)) result.set(name, []);
    result.get(name).push(item);
  }
  return result;
}
