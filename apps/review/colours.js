// Colours of everything: poses, regions, gap methods, ramps.
const SERIES = ['#e0a458', '#7fb0d6', '#8fbf7f', '#d17a7a', '#a58bd1', '#5fb8b0', '#d9c35a', '#d48cc0', '#b98a62', '#9fb3c8'];

// Told apart with any colour vision (after Okabe and Ito); holes are hatched besides.
const GAP_COLOURS = {
  missing: '#ff7f50', spline: '#56b4e9', rigid_group: '#1fb488', local_frame: '#d58ab8', low_rank: '#e69f00',
};
const GAP_NAMES = {
  missing: 'left open', spline: 'spline', rigid_group: 'rigid group', local_frame: 'local frame', low_rank: 'from the other markers',
};

// Regions: hues spread by the golden angle at one lightness, so that neighbours in the list differ.
function regionColour(index) {
  const hue = (24 + index * 137.508) % 360;
  return hslToRgb(hue / 360, 0.36, 0.54);
}

function hslToRgb(h, s, l) {
  const part = n => {
    const k = (n + h * 12) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [part(0), part(8), part(4)];
}

const css = rgb => `rgb(${rgb.map(v => Math.round(255 * v)).join(',')})`;
const toLinear = v => v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4);

// Distance ramp: quiet where it is small, warm where it matters.
const RAMP = [[0.00, [0.30, 0.35, 0.40]], [0.25, [0.27, 0.55, 0.57]], [0.50, [0.80, 0.76, 0.42]],
              [0.75, [0.88, 0.52, 0.25]], [1.00, [0.80, 0.20, 0.22]]];
const NO_VALUE = [0.27, 0.24, 0.30];

function ramp(share) {
  if (isNaN(share)) return NO_VALUE;
  const s = Math.max(0, Math.min(1, share));
  for (let i = 1; i < RAMP.length; ++i) {
    if (s > RAMP[i][0]) continue;
    const along = (s - RAMP[i - 1][0]) / (RAMP[i][0] - RAMP[i - 1][0]);
    return RAMP[i - 1][1].map((v, c) => v + along * (RAMP[i][1][c] - v));
  }
  return RAMP[RAMP.length - 1][1];
}
const rampCss = () => `linear-gradient(90deg, ${RAMP.map(([at, rgb]) => `${css(rgb)} ${100 * at}%`).join(', ')})`;
