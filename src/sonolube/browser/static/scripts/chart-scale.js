/**
 * Ends, ticks, numbers and colours of charts, as Matplotlib gives them to the same chart.
 *
 * @typedef {{label?: string, text?: string, unit?: string, logarithmic?: boolean, words?: string[], ticks?: number[],
 *   lowest?: number, highest?: number, reciprocal?: [number, string], proportional?: [number, string]}} Axis
 * @typedef {'x'|'y'} Name of an axis
 * @typedef {Record<Name, number[]>} Ranges ends of both axes
 * @typedef {{panels: Panel[], columns: number, size: number[], widths?: number[], heights?: number[], shares_x?:
 *   boolean, shares_y?: boolean, legend?: string, legend_title?: string, title?: string}} ChartData
 * @typedef {(number|null)[]} Values those that are not known are null
 * @typedef {{kind: string, label?: string, [name: string]: any}} Part
 * @typedef {{x: Axis, y: Axis, parts: Part[], title?: string, has_equal_scales?: boolean}} Panel
 * @typedef {import('./chart-field.js').FieldPart} FieldPart
 * @typedef {ReturnType<typeof along>} Along
 * @typedef {ReturnType<typeof themeOf>} Theme
 */

const SUPERSCRIPTS = '⁻⁰¹²³⁴⁵⁶⁷⁸⁹';
const MARGIN = 0.05; // of the range of the data, at both ends
const LOG_RATIO = 3; // of the ends of a logarithmic axis, below which its ticks are those of a linear one
const MIN_CONTRAST = {light: 3, dark: 4.5}; // of a curve against what it is drawn on
const DASHES = [[], [7, 4], [8, 3, 2, 3], [2, 3], [9, 2], [5, 2, 2, 2, 2, 2], [1.5, 1.5]];

/** @param {number} [number] @returns {number[]} */
export const dash = (number) => DASHES[(number ?? 0) % DASHES.length];

/** Number as a short text. @param {number|null} value @param {number} [digits] @returns {string} */
export function short(value, digits = 4) {
  if (value == null || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size && (size >= 10 ** Math.max(digits + 1, 6) || size < 1e-4)) {
    const [number, power] = value.toExponential(digits - 1).split('e');
    const raised = [...String(Number(power))].map((sign) => SUPERSCRIPTS['-0123456789'.indexOf(sign)]).join('');
    return Number(number) === 1 ? `10${raised}` : `${Number(number)}·10${raised}`;
  }
  return String(Number(value.toPrecision(digits)));
}

/**
 * Word that stands for a value on an axis; undefined where numbers stand.
 * @param {Axis} axis
 * @param {number} value
 * @returns {string|undefined}
 */
const wordAt = ({words, ticks}, value) => words?.[ticks ? ticks.indexOf(value) : Math.round(value)];

/**
 * Number of an axis or field with its unit, or the word that stands there.
 * @param {number} value
 * @param {Axis} axis
 * @returns {string}
 */
export const withUnit = (value, axis) =>
  wordAt(axis, value) ?? (axis.unit ? `${short(value)} ${axis.unit}` : short(value));

/**
 * Errors of points or bars below and above a place; undefined where there are none.
 * @param {any[]|undefined} error
 * @param {number} place
 * @returns {number[]|undefined}
 */
export const errors = (error, place) =>
  error && (Array.isArray(error[0]) ? error.map((ends) => ends[place]) : [error[place], error[place]]);

/** Label on one line; empty without one. @param {string} [text] @returns {string} */
export const flat = (text = '') => text.replaceAll('\n', ' ');

/** Field of a panel; undefined where it has none. @param {Panel} panel @returns {(Part & FieldPart)|undefined} */
export const fieldOf = (panel) =>
  /** @type {(Part & FieldPart)|undefined} */ (panel.parts.find((part) => part.kind === 'field'));

/**
 * Lowest and highest of some values, without those that are not known.
 * @param {Iterable<number|null>} values
 * @returns {[number, number]}
 */
export const extent = (values) => {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) if (value !== null) [low, high] = [Math.min(low, value), Math.max(high, value)];
  return [low, high];
};

/**
 * Way from values of an axis to a scale on which they lie evenly, and back.
 * @param {Axis} axis
 * @returns {[(value: number) => number, (value: number) => number]}
 */
const evenly = (axis) =>
  axis.logarithmic ? [Math.log10, (value) => 10 ** value] : [(value) => value, (value) => value];

/**
 * Places of values along an axis that begins at `start`, and back; by default as shares of its length.
 * @param {Axis} axis
 * @param {number[]} ends
 * @param {number} [start]
 * @param {number} [length]
 */
export function along(axis, ends, start = 0, length = 1) {
  const [to, from] = evenly(axis);
  const [low, high] = ends.map(to);
  return {
    ends,
    /** @param {number} value */
    to: (value) => start + ((to(value) - low) / (high - low)) * length,
    /** @param {number} place */
    back: (place) => from(low + ((place - start) / length) * (high - low)),
  };
}

/** Values where others are known. @param {Values} values @param {Values} others @returns {Values} */
const known = (values, others) => values.filter((_, place) => others[place] !== null);

/** Values of a part along an axis, by its kind. @type {Record<string, (part: Part, name: Name) => Values>} */
const VALUES = {
  field: (part, name) => part[name],
  line: (part, name) => known(part[name], part[name === 'x' ? 'y' : 'x']),
  band: ({x, low, high}, name) => (name === 'x' ? known(x, low) : [...low, ...high]),
  points: (part, name) =>
    /** @type {number[]} */ (part[name]).flatMap((value, place) => {
      const [below, above] = errors(part[`${name}_error`], place) ?? [];
      return below === undefined ? [value] : [value, value - below, value + above];
    }),
  rule: (part, name) => (part.along === name ? [part.value] : []),
  zone: (part, name) => (part.along === name ? [...part.first, ...part.last] : []),
  bars: (part, name) =>
    part.along === name
      ? [0, ...part.lengths]
      : /** @type {number[]} */ (part.places).flatMap((place) => [place - part.breadth / 2, place + part.breadth / 2]),
  note: () => [],
};

/** Whether an axis is stated to run down. @param {Axis} axis @returns {boolean} */
export const isReversed = ({lowest = -Infinity, highest = Infinity}) => lowest > highest;

/**
 * Ends of an axis over some panels.
 * @param {Panel[]} panels
 * @param {Name} name
 */
function ends(panels, name) {
  const axis = panels[0][name];
  const {logarithmic} = axis;
  const parts = panels.flatMap((panel) => panel.parts);
  const isFromZero = parts.some((part) => part.kind === 'bars' && part.along === name);
  let [low, high] = extent(
    parts.flatMap((part) => VALUES[part.kind](part, name)).filter((value) => !logarithmic || (value ?? 0) > 0),
  );
  if (low > high) [low, high] = logarithmic ? [1, 10] : [0, 1];
  const [to, from] = evenly(axis);
  let [first, last] = [to(low), to(high)];
  if (first === last) {
    const half = first === 0 || logarithmic ? 0.5 : Math.abs(first) * MARGIN;
    [first, last] = [first - half, last + half];
  }
  const margin = panels.some(fieldOf) ? 0 : MARGIN * (last - first);
  /** @param {number} end */
  const isZero = (end) => isFromZero && end === 0;
  const found = [
    axis.lowest ?? from(isZero(first) ? 0 : first - margin),
    axis.highest ?? from(isZero(last) ? 0 : last + margin),
  ];
  if (axis.ticks) found.splice(0, 2, Math.min(found[0], ...axis.ticks), Math.max(found[1], ...axis.ticks));
  if (!(found[1] > found[0]) && !isReversed(axis)) found[1] = found[0] + (Math.abs(found[0]) || 1);
  return found;
}

/**
 * Ends of x and y of each panel, common where the chart shares them; `kept` are charts drawn behind.
 * @param {ChartData} chart
 * @param {ChartData[]} kept
 * @returns {Ranges[]}
 */
export function rangesOf(chart, kept) {
  const {columns} = chart;
  const joined = chart.panels.map((panel, place) => {
    const behind = kept.flatMap((each) => (each.panels[place]?.parts ?? []).filter((part) => part.kind === 'line'));
    return {...panel, parts: [...panel.parts, ...behind]};
  });
  /** @param {Name} name @param {boolean|undefined} isShared @param {(one: number, other: number) => boolean} same */
  const among = (name, isShared, same) =>
    joined.map((panel, place) =>
      ends(
        isShared
          ? [panel, ...joined.filter((other, at) => at !== place && same(at, place) && other.parts.length)]
          : [panel],
        name,
      ),
    );
  const x = among('x', chart.shares_x, (one, other) => one % columns === other % columns);
  const y = among('y', chart.shares_y, (one, other) => Math.floor(one / columns) === Math.floor(other / columns));
  return joined.map((_, place) => ({x: x[place], y: y[place]}));
}

/**
 * Round numbers within a range, at most `most`.
 * @param {number} low
 * @param {number} high
 * @param {number} most
 * @returns {number[]}
 */
export function roundTicks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step =
    [1, 2, 2.5, 5, 10].map((each) => each * decade).find((each) => each >= rough * (1 - 1e-9)) ?? 10 * decade;
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  return Array.from({length: Math.max(last - first + 1, 0)}, (_, at) => Number(((first + at) * step).toPrecision(12)));
}

/**
 * Ticks of an axis with room for so many numbers.
 * @param {Axis} axis
 * @param {number[]} ends
 * @param {number} room
 * @returns {number[]}
 */
export function ticksOf(axis, ends, room) {
  const [low, high] = [...ends].sort((one, other) => one - other);
  if (axis.ticks) return axis.ticks;
  if (axis.words) return axis.words.map((_, place) => place);
  if (!axis.logarithmic || high / low < LOG_RATIO) return roundTicks(low, high, Math.min(room, 8));
  const decades = Math.log10(high / low);
  const within = [];
  const steps = 3 * decades < room ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / room));
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    if (power % every) continue;
    for (const step of steps) {
      const value = Number((step * 10 ** power).toPrecision(3));
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)) within.push(value);
    }
  }
  return within;
}

/** Texts at ticks. @param {Axis} axis @param {number[]} ticks @returns {string[]} */
export const tickTexts = (axis, ticks) => ticks.map((value) => wordAt(axis, value) ?? short(value, 5));

/** Red, green and blue of "#rrggbb" or "rgb(…)". @param {string} text @returns {number[]} */
export const rgb = (text) =>
  text.startsWith('#')
    ? [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16))
    : (text.match(/[\d.]+/g) ?? [0, 0, 0]).slice(0, 3).map(Number);

/** @param {number[]} colour @returns {string} */
export const css = (colour) => `rgb(${colour.map(Math.round).join(' ')})`;
/** @param {number[]} one @param {number[]} other @param {number} share @returns {number[]} */
export const mix = (one, other, share) => one.map((value, place) => value + share * (other[place] - value));

/** @param {number[]} colour */
function luminance(colour) {
  /** @param {number} part */
  const linear = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
  const [red, green, blue] = colour.map((value) => linear(value / 255));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** @param {number[]} one @param {number[]} other */
function contrast(one, other) {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}

/**
 * Colours of a theme, read from the style of an element; `stroke` and `fill` give those that stand for a colour of a
 * chart.
 * @param {Element} element
 */
export function themeOf(element) {
  const style = getComputedStyle(element);
  const [ink, surface] = [rgb(style.color), rgb(style.backgroundColor)];
  const least = luminance(surface) < 0.2 ? MIN_CONTRAST.dark : MIN_CONTRAST.light;
  /** @param {string} colour @param {boolean} isStroke */
  const shown = (colour, isStroke) => {
    let found = rgb(colour);
    const isGrey = found[0] === found[1] && found[1] === found[2];
    if (isGrey) found = mix(surface, ink, 1 - found[0] / 255);
    for (let step = 0; isStroke && !isGrey && step < 12 && contrast(found, surface) < least; step += 1)
      found = mix(found, ink, 0.1);
    return css(found);
  };
  return {
    ink: css(ink),
    surface: css(surface),
    grid: css(mix(surface, ink, 0.13)),
    muted: css(mix(surface, ink, 0.72)),
    kept: css(mix(surface, ink, 0.45)),
    /** @param {string} colour */
    stroke: (colour) => shown(colour, true),
    /** @param {string} colour */
    fill: (colour) => shown(colour, false),
  };
}
