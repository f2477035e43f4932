/** Fields of a chart: filled contours or cells, contour lines with their values, and the scale of colours. */
import {html} from '../vendor/htm-preact-3.1.1.js';
import {css, extent, mix, rgb, roundTicks, short} from './chart-scale.js';

/**
 * @import {Along, Values} from './chart-scale.js'
 * @typedef {{x: number[], y: number[], values: Values[], levels?: number[], lines?: number[], lowest?: number,
 *   highest?: number, scale: string, scale_text?: string, words?: string[], label?: string, unit?: string}} FieldPart
 * @typedef {Partial<FieldPart> & {values: Values[]}} Scaled what a scale of colours is of
 * @typedef {{left: number, top: number, width: number, height: number}} Box
 * @typedef {{box: Box, x: Along, y: Along}} Mapping of the axes of a panel to its canvas
 * @typedef {[number, number]} Point
 */

/** @type {Record<string, string[]>} */
const STOPS = {
  cividis: [
    '#00224e',
    '#123570',
    '#3b496c',
    '#575d6d',
    '#707173',
    '#8a8678',
    '#a59c74',
    '#c3b369',
    '#e1cc55',
    '#fee838',
  ],
  viridis: [
    '#440154',
    '#482878',
    '#3e4989',
    '#31688e',
    '#26828e',
    '#1f9e89',
    '#35b779',
    '#6ece58',
    '#b5de2b',
    '#fde725',
  ],
  grey: ['#ffffff', '#f0f0f0', '#d9d9d9', '#bdbdbd', '#969696', '#737373', '#525252', '#252525', '#000000'],
};
const CATEGORIES = ['#bfbfbf', '#9ecae1', '#fdd0a2', '#c7e9c0', '#dadaeb'];
const MIN_PIECES = 4; // of a contour line that gets a label
const CORNERS = [
  [0, 0],
  [1, 0],
  [1, 1],
  [0, 1],
]; // of a cell, in their order around it
const MARGIN = 0.06; // of width and height, in which no label stands

/** Colour of a share of a scale. @param {string} name @param {number} share @returns {number[]} */
export function colourAt(name, share) {
  const stops = STOPS[name] ?? STOPS.cividis;
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(place), stops.length - 2);
  return mix(rgb(stops[low]), rgb(stops[low + 1]), place - low);
}

/** @param {number} number @returns {string} */
export const categoryColour = (number) => CATEGORIES[number % CATEGORIES.length];

/**
 * Ends of the scale of a field.
 * @param {Scaled} field
 */
function endsOf({levels, lowest, highest, values}) {
  if (levels) return [levels[0], levels[levels.length - 1]];
  if (lowest !== undefined && highest !== undefined) return [lowest, highest];
  const [low, high] = extent(values.flat());
  return [lowest ?? low, highest ?? high];
}

/**
 * Colours of a field: of a value, and the ends of the scale.
 * @param {Scaled} field
 * @returns {{ends: number[], colour: (value: number) => number[]}}
 */
export function scaleOf(field) {
  const {levels, scale = '', words} = field;
  if (words) return {ends: [0, words.length - 1], colour: (value) => rgb(categoryColour(Math.round(value)))};
  const [low, high] = endsOf(field);
  /** @param {number} value */
  const share = (value) => (high > low ? (value - low) / (high - low) : 0.5);
  if (!levels) return {ends: [low, high], colour: (value) => colourAt(scale, share(value))};
  const colours = levels.slice(1).map((level, place) => colourAt(scale, share((level + levels[place]) / 2)));
  const inner = levels.slice(1, -1); // below the first and from the last on, the colours of the ends hold
  /** @param {number} value */
  const placed = (value) => inner.findIndex((level) => value < level);
  return {ends: [low, high], colour: (value) => /** @type {number[]} */ (colours.at(placed(value)))};
}

/**
 * Place between the values of an ascending axis, as its number with a fraction; null beyond its ends.
 * @param {number[]} axis
 * @param {number} value
 * @param {boolean} isCell
 * @returns {number|null}
 */
function placeOn(axis, value, isCell) {
  const last = axis.length - 1;
  const [first, end] = [axis[0], axis[last]];
  const half = isCell && last > 0 ? [(axis[1] - first) / 2, (end - axis[last - 1]) / 2] : [0, 0];
  const slack = 1e-9 * Math.abs(end - first);
  if (value < first - half[0] - slack || value > end + half[1] + slack) return null;
  const low = Math.max(
    0,
    axis.findLastIndex((each, at) => at < last && each <= value),
  );
  return low + Math.min(Math.max((value - axis[low]) / (axis[Math.min(low + 1, last)] - axis[low] || 1), -0.5), 1.5);
}

/**
 * Value of a field at a place of its grid: between the grid's values for contours, of the cell otherwise.
 * @param {FieldPart} field
 * @param {number|null} column
 * @param {number|null} row
 * @returns {number|null}
 */
function valueAt(field, column, row) {
  const {values, levels} = field;
  if (column === null || row === null) return null;
  if (!levels) return values[Math.round(Math.max(row, 0))]?.[Math.round(Math.max(column, 0))] ?? null;
  const [left, below] = [
    Math.min(Math.floor(column), field.x.length - 2),
    Math.min(Math.floor(row), field.y.length - 2),
  ];
  const [right, above] = [column - left, row - below];
  const corners = [values[below][left], values[below][left + 1], values[below + 1][left], values[below + 1][left + 1]];
  if (corners.includes(null)) return null;
  const [one, two, three, four] = /** @type {number[]} */ (corners);
  return (1 - above) * ((1 - right) * one + right * two) + above * ((1 - right) * three + right * four);
}

/**
 * Value of a field over the axes; null where it is not known.
 * @param {FieldPart} field
 * @param {number} x
 * @param {number} y
 * @returns {number|null}
 */
export const readField = (field, x, y) =>
  valueAt(field, placeOn(field.x, x, !field.levels), placeOn(field.y, y, !field.levels));

const images = new WeakMap();

/**
 * Picture of a field in the pixels of a panel, computed once for each size.
 * @param {FieldPart} field
 * @param {Mapping} map
 */
function imageOf(field, map) {
  const {width, height} = map.box;
  const key = `${width} ${height} ${map.x.ends} ${map.y.ends}`;
  const last = images.get(field);
  if (last?.key === key) return last.canvas;
  const canvas = new OffscreenCanvas(width, height);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext('2d'));
  const image = context.createImageData(width, height);
  const {colour} = scaleOf(field);
  const columns = Array.from({length: width}, (_, at) =>
    placeOn(field.x, map.x.back(map.box.left + at + 0.5), !field.levels),
  );
  for (let at = 0; at < height; at += 1) {
    const row = placeOn(field.y, map.y.back(map.box.top + at + 0.5), !field.levels);
    for (let across = 0; across < width && row !== null; across += 1) {
      const value = valueAt(field, columns[across], row);
      if (value === null) continue;
      const found = colour(value);
      const start = 4 * (at * width + across);
      for (let part = 0; part < 3; part += 1) image.data[start + part] = found[part];
      image.data[start + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  images.set(field, {key, canvas});
  return canvas;
}

/**
 * Pieces of the contour line of a level, one or two for each crossed cell of the grid, by marching squares.
 * @param {FieldPart} field
 * @param {number} level
 * @param {Mapping} map
 * @returns {[Point, Point][]}
 */
function pieces({x, y, values}, level, map) {
  /** @type {[Point, Point][]} */
  const found = [];
  for (let row = 0; row < y.length - 1; row += 1) {
    for (let column = 0; column < x.length - 1; column += 1) {
      const around = CORNERS.map(([right, up]) => [x[column + right], y[row + up], values[row + up][column + right]]);
      if (around.some(([, , value]) => value === null)) continue;
      const corners = /** @type {number[][]} */ (around);
      const isAbove = corners.map(([, , value]) => value >= level);
      /** @type {Point[]} */
      const crossed = corners.flatMap((one, side) => {
        const next = (side + 1) % 4;
        if (isAbove[side] === isAbove[next]) return [];
        const share = (level - one[2]) / (corners[next][2] - one[2]);
        const [across, upward] = [0, 1].map((axis) => one[axis] + share * (corners[next][axis] - one[axis]));
        return [/** @type {Point} */ ([map.x.to(across), map.y.to(upward)])];
      });
      const isMiddle = corners.reduce((sum, [, , value]) => sum + value, 0) / 4 >= level;
      // which corners of a saddle are joined
      if (crossed.length === 4 && isMiddle !== isAbove[0]) crossed.push(...crossed.splice(0, 1));
      for (let at = 0; at < crossed.length; at += 2) found.push([crossed[at], crossed[at + 1]]);
    }
  }
  return found;
}

/**
 * Draw a field between the axes.
 * @param {CanvasRenderingContext2D} context
 * @param {FieldPart} field
 * @param {Mapping} map
 * @param {number} scale
 */
export function drawField(context, field, map, scale) {
  context.drawImage(imageOf(field, map), map.box.left, map.box.top);
  if (!field.levels || !field.lines) return;
  const lines = field.lines.map((level) => ({text: short(level, 3), found: pieces(field, level, map)}));
  context.strokeStyle = 'white';
  context.lineWidth = 0.9 * scale;
  context.beginPath();
  for (const [one, other] of lines.flatMap(({found}) => found)) {
    context.moveTo(...one);
    context.lineTo(...other);
  }
  context.stroke();
  Object.assign(context, {
    font: `${9.5 * scale}px sans-serif`,
    textAlign: 'center',
    textBaseline: 'middle',
    lineJoin: 'round',
  });
  Object.assign(context, {lineWidth: 3 * scale, strokeStyle: '#2a3f6e', fillStyle: 'white'});
  for (const {text, found} of lines) {
    const label = labelOf(found, map.box);
    if (!label) continue;
    context.save();
    context.translate(label.x, label.y);
    context.rotate(label.angle);
    context.strokeText(text, 0, 0);
    context.fillText(text, 0, 0);
    context.restore();
  }
}

/**
 * Place and angle of the label of a line: where it is nearest to the rising diagonal; null where it has no room.
 * @param {[Point, Point][]} found
 * @param {Box} box
 */
function labelOf(found, {left, top, width, height}) {
  /** @param {[Point, Point]} piece */
  const far = ([[x, y]]) => Math.abs((x - left) / width - (top + height - y) / height);
  const inner = found.filter(
    ([[x, y]]) =>
      x > left + MARGIN * width &&
      x < left + (1 - MARGIN) * width &&
      y > top + MARGIN * height &&
      y < top + (1 - MARGIN) * height,
  );
  if (inner.length < MIN_PIECES) return null;
  const [[x, y], [nextX, nextY]] = inner.reduce((best, each) => (far(each) < far(best) ? each : best));
  const angle = Math.atan((nextY - y) / (nextX - x || 1e-9));
  return {x: (x + nextX) / 2, y: (y + nextY) / 2, angle};
}

/** Scale of colours with its text, as high as a panel. @param {{field: Scaled, height: number}} properties */
export function ColourScale({field, height}) {
  const {
    ends: [low, high],
    colour,
  } = scaleOf(field);
  const [top, room] = [8, Math.max(height - 16, 60)];
  const {levels} = field;
  const edges = levels ?? Array.from({length: 65}, (_, at) => low + (at / 64) * (high - low));
  /** @param {number} value */
  const y = (value) => top + room * (1 - (value - low) / (high - low || 1));
  const ticks =
    levels && field.lines
      ? levels.filter((_, at) => at % Math.max(1, Math.floor((levels.length - 1) / 5)) === 0)
      : roundTicks(low, high, 6);
  return html`<svg
    class="chart-colours"
    width="66"
    height=${height}
    role="img"
    aria-label=${`Colours: ${field.scale_text}, from ${short(low)} to ${short(high)}`}
  >
    ${edges.slice(1).map(
      (edge, at) => html`<rect
        key=${at}
        x="2"
        width="13"
        y=${y(edge)}
        height=${y(edges[at]) - y(edge) + 0.5}
        fill=${css(colour((edge + edges[at]) / 2))}
      />`,
    )}
    ${ticks.map((tick) => html`<text key=${tick} x="19" y=${y(tick)} dy="0.35em">${short(tick, 3)}</text>`)}
    <text class="chart-axis-text" transform=${`translate(60 ${top + room / 2}) rotate(-90)`} text-anchor="middle">
      ${field.scale_text}
    </text>
  </svg>`;
}
