/** Parts of a panel drawn on its canvas, in the order in which they are given. */
import {colourAt, drawField, readField, scaleOf} from './chart-field.js';
import {along, css, dash, errors, extent, fieldOf, flat, short, withUnit} from './chart-scale.js';
/**
 * @import {Box, Mapping, Point, Scaled} from './chart-field.js'
 * @import {Axis, Name, Panel, Part, Ranges, Theme, Values} from './chart-scale.js'
 * @typedef {{part: Part, at: number, x: number, y: number}} PartPoint point of a part, by its number in it
 */

const LINE = 1.7; // px
const MARKER = 3.6; // px, half of its width
const NEAR = 16; // px from a point within which it is read
/** @type {Record<Name, Name>} */
const OTHER = {x: 'y', y: 'x'}; // axis
/** @type {Record<string, [number, CanvasTextAlign, number]>} */
const SIDES = {right: [6, 'left', 0], left: [-6, 'right', 0], above: [0, 'center', -9]}; // of a note
/**
 * X and y of what lies along an axis and across it.
 * @template T
 * @param {Name} name
 * @param {T} lengthwise
 * @param {T} crosswise
 * @returns {[T, T]}
 */
const placed = (name, lengthwise, crosswise) => (name === 'x' ? [lengthwise, crosswise] : [crosswise, lengthwise]);
/** Order in which kinds of parts are drawn, 3 for the others. @type {Record<string, number>} */
const ORDER = {zone: 0, field: 1, band: 2, points: 4, note: 5};
/** Markers of unit size about zero, as paths of SVG. */
export const MARKERS = [
  'M-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0Z',
  'M-.9-.9H.9V.9H-.9Z',
  'M0-1.1 1 .9H-1Z',
  'M0-1.25 1.25 0 0 1.25-1.25 0Z',
  'M0 1.1 1-.9H-1Z',
  'M-.4-1.2H.4V-.4H1.2V.4H.4V1.2H-.4V.4H-1.2V-.4H-.4Z',
  'M-1.1-.6-.6-1.1 0-.5.6-1.1 1.1-.6.5 0 1.1.6.6 1.1 0 .5-.6 1.1-1.1.6-.5 0Z',
  'M-1.1 0 .9-1V1Z',
  'M1.1 0-.9-1V1Z',
  'M0-1.4.33-.45 1.33-.43.53.17.82 1.13 0 .56-.82 1.13-.53.17-1.33-.43-.33-.45Z',
];

/**
 * Places of values on a canvas and back; `box` in its pixels.
 * @param {Panel} panel
 * @param {Ranges} ranges
 * @param {Box} box
 * @returns {Mapping}
 */
export const mapping = (panel, ranges, box) => ({
  box,
  x: along(panel.x, ranges.x, box.left, box.width),
  y: along(panel.y, ranges.y, box.top + box.height, -box.height),
});

/**
 * Trace a curve, and give its places in pixels; null where it is interrupted.
 * @param {CanvasRenderingContext2D} context
 * @param {Part} line
 * @param {Mapping} map
 * @returns {(Point|null)[]}
 */
function trace(context, line, map) {
  /** @type {Point|null} */
  let before = null;
  context.beginPath();
  return /** @type {Values} */ (line.x).map((x, at) => {
    /** @type {Point} */
    const found = [map.x.to(x ?? NaN), map.y.to(line.y[at] ?? NaN)];
    const place = found.every(Number.isFinite) ? found : null;
    if (place && before && line.is_stepped) context.lineTo(place[0], before[1]);
    if (place) context[before ? 'lineTo' : 'moveTo'](...place);
    before = place;
    return place;
  });
}

/**
 * Draw the parts of a panel.
 * @param {CanvasRenderingContext2D} context
 * @param {Panel} panel
 * @param {{map: Mapping, theme: Theme, scale: number, behind: Part[], rule?: Part|null, held: number|null, ringed?: {x:
 *   number, y: number}}} how `behind` are kept lines; `held` is where the dragged `rule` stands, null where its data
 *   say it; `ringed` is a point that is chosen
 */
export function drawParts(context, panel, {map, theme, scale, behind, rule: dragged, held, ringed}) {
  /** @type {Record<string, (part: any) => void>} */
  const draw = {line, band, points, rule, zone, bars, note, field: (part) => drawField(context, part, map, scale)};
  const {left, top, width, height} = map.box;
  /** @type {Ranges} */
  const whole = {x: [left, left + width], y: [top, top + height]};
  /** @param {() => void} work */
  const inside = (work) => {
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    work();
    context.restore();
  };
  const kept = behind.map((part, at) => ({...part, dash: at, weight: 0.9, isKept: true}));
  /** @param {Part} part */
  const order = (part) => (part.isKept ? 2.5 : part.kind === 'points' && part.is_faint ? 1 : (ORDER[part.kind] ?? 3));
  [...panel.parts, ...kept]
    .sort((one, other) => order(one) - order(other))
    .forEach((part) => {
      if (part.kind === 'points' || part.kind === 'note') draw[part.kind](part);
      else inside(() => draw[part.kind](part));
    });
  if (ringed) {
    context.beginPath();
    context.arc(map.x.to(ringed.x), map.y.to(ringed.y), 2.6 * MARKER * scale, 0, 2 * Math.PI);
    stroke(theme.stroke('#d55e00'), 2.4);
  }

  /** @param {Part} part */
  function line(part) {
    const colour = part.isKept ? theme.kept : theme.stroke(part.colour);
    const places = trace(context, part, map);
    context.lineJoin = 'round';
    if (part.has_halo) stroke('white', LINE * part.weight + 2);
    stroke(part.has_halo ? css([20, 20, 20]) : colour, LINE * part.weight, dash(part.dash));
    if (part.marker == null) return;
    for (const place of places) if (place) mark(part.marker, 0.8 * MARKER * scale, place, colour);
  }

  /** @param {string} colour @param {number} lineWidth @param {number[]} dashes */
  function stroke(colour, lineWidth, dashes = []) {
    context.strokeStyle = colour;
    context.lineWidth = lineWidth * scale;
    context.setLineDash(dashes.map((length) => length * scale));
    context.stroke();
    context.setLineDash([]);
  }

  /**
   * Trace a straight line along an axis, at a place of the other.
   * @param {Name} name
   * @param {number[]} ends
   * @param {number} across
   */
  function straight(name, [one, other], across) {
    context.moveTo(...placed(name, one, across));
    context.lineTo(...placed(name, other, across));
  }

  /**
   * Fill from one place to another of an axis, and of the other one.
   * @param {Name} name
   * @param {number[]} lengthwise
   * @param {number[]} crosswise
   */
  function fill(name, lengthwise, crosswise) {
    const [x, y] = placed(name, lengthwise, crosswise);
    context.fillRect(x[0], y[0], x[1] - x[0], y[1] - y[0]);
  }

  /**
   * @param {number} marker
   * @param {number} size
   * @param {Point} place
   * @param {string} colour
   * @param {{isHollow?: boolean, edge?: string}} how
   */
  function mark(marker, size, [x, y], colour, {isHollow = false, edge = theme.surface} = {}) {
    const path = new Path2D(MARKERS[marker % MARKERS.length]);
    context.save();
    context.translate(x, y);
    context.scale(size, size);
    context.fillStyle = colour;
    context.strokeStyle = isHollow ? colour : edge;
    context.lineWidth = ((isHollow || edge === 'white' ? 1.3 : 0.8) * scale) / size;
    if (!isHollow) context.fill(path);
    context.stroke(path);
    context.restore();
  }

  /** @param {Part} part */
  function band(part) {
    const known = [.../** @type {Values} */ (part.x).keys()].filter((at) =>
      [part.x, part.low, part.high].every((values) => values[at] !== null),
    );
    /** @param {number[]} values @param {number[]} places */
    const edge = (values, places) => places.forEach((at) => context.lineTo(map.x.to(part.x[at]), map.y.to(values[at])));
    context.beginPath();
    for (let first = 0, at = 1; at <= known.length; at += 1) {
      if (known[at] === known[at - 1] + 1) continue; // a run without gaps
      const run = known.slice(first, at);
      context.moveTo(map.x.to(part.x[run[0]]), map.y.to(part.low[run[0]]));
      edge(part.low, run);
      edge(part.high, run.reverse());
      first = at;
    }
    context.globalAlpha = part.opacity;
    context.fillStyle = theme.fill(part.colour);
    context.fill();
    context.globalAlpha = 1;
  }

  /** @param {Part} part */
  function points(part) {
    const colour = theme.stroke(part.colour);
    const size = (part.is_faint ? 0.4 : part.shades ? 1.3 * Math.sqrt(part.size) : part.size) * MARKER * scale;
    const shade = part.shades && shadeOf(part, panel);
    /** @type {Values} */ (part.x).forEach((x, at) => {
      if (x === null || part.y[at] === null) return;
      /** @type {Point} */
      const place = [map.x.to(x), map.y.to(part.y[at])];
      inside(() => {
        bar(errors(part.y_error, at), part.y[at], place, 'y', colour);
        bar(errors(part.x_error, at), x, place, 'x', colour);
      });
      context.globalAlpha = part.is_faint ? 0.6 : 1;
      mark(part.marker, size, place, shade ? css(shade(part.shades[at])) : colour, {
        isHollow: part.is_hollow,
        edge: part.is_faint ? colour : shade ? 'white' : theme.surface,
      });
      context.globalAlpha = 1;
      if (part.texts?.[at]) write(part.texts[at], place[0] + 7 * scale, place[1], 'left', theme.ink, true);
    });
  }

  /**
   * Error bar of a value at a place.
   * @param {number[]|undefined} lengths
   * @param {number} value
   * @param {Point} place
   * @param {Name} name
   * @param {string} colour
   */
  function bar(lengths, value, [x, y], name, colour) {
    if (!lengths) return;
    const across = name === 'x' ? y : x;
    const ends = [map[name].to(value - lengths[0]), map[name].to(value + lengths[1])];
    const cap = 2.5 * scale;
    context.beginPath();
    straight(name, ends, across);
    ends.forEach((end) => straight(OTHER[name], [across - cap, across + cap], end));
    stroke(colour, 1);
  }

  /** @param {Part & {along: Name}} part */
  function rule(part) {
    const value = held !== null && part === dragged ? held : part.value;
    context.beginPath();
    straight(OTHER[part.along], whole[OTHER[part.along]], map[part.along].to(value));
    stroke(theme.stroke(part.colour), 1.1, dash(part.dash));
  }

  /** @param {Part & {along: Name}} part */
  function zone(part) {
    context.globalAlpha = part.opacity;
    context.fillStyle = theme.fill(part.colour);
    /** @type {number[]} */ (part.first).forEach((first, at) =>
      fill(part.along, [first, part.last[at]].map(map[part.along].to), whole[OTHER[part.along]]),
    );
    context.globalAlpha = 1;
  }

  /** @param {Part & {along: Name}} part */
  function bars(part) {
    const {along: name, breadth} = part;
    const [lengthwise, across] = [map[name], map[OTHER[name]]];
    /** @type {number[]} */ (part.places).forEach((place, at) => {
      /** @type {number|null} */
      const length = part.lengths[at];
      if (length === null) return;
      const [from, to, middle] = [
        lengthwise.to(Math.max(lengthwise.ends[0], 0)),
        lengthwise.to(length),
        across.to(place),
      ];
      context.fillStyle = theme.stroke(part.colour);
      fill(name, [from, to], [place - breadth / 2, place + breadth / 2].map(across.to));
      const lengths = errors(part.error, at);
      bar(lengths, length, placed(name, to, middle), name, theme.ink);
      const end = lengths ? lengthwise.to(length + lengths[1]) : to;
      if (!part.texts?.[at]) return;
      if (name === 'x') write(part.texts[at], end + 4 * scale, middle, 'left', theme.ink);
      else write(part.texts[at], middle, end - 8 * scale, 'center', theme.ink);
    });
  }

  /** @param {Part} part */
  function note(part) {
    const [x, y] = [map.x.to(part.x), map.y.to(part.y)];
    const [shift, align, rise] = SIDES[part.side];
    write(part.text, x + shift * scale, y + rise * scale, align, theme.stroke(part.colour));
  }

  /**
   * @param {string} text
   * @param {number} x
   * @param {number} y
   * @param {CanvasTextAlign} align
   * @param {string} colour
   * @param {boolean} [isBoxed]
   */
  function write(text, x, y, align, colour, isBoxed = false) {
    context.font = `${11 * scale}px sans-serif`;
    context.textAlign = align;
    context.textBaseline = 'middle';
    if (isBoxed) {
      context.lineWidth = 3 * scale;
      context.lineJoin = 'round';
      context.strokeStyle = theme.surface;
      context.strokeText(text, x, y);
    }
    context.fillStyle = colour;
    text.split('\n').forEach((row, at) => context.fillText(row, x, y + at * 13 * scale));
  }
}

/**
 * Colours of shaded points: those of the field below them, or of a scale of their own.
 * @param {Part} part
 * @param {Panel} panel
 * @returns {(value: number) => number[]}
 */
function shadeOf(part, panel) {
  const below = fieldOf(panel);
  if (below) return scaleOf(below).colour;
  const [low, high] = ownEnds(part);
  return (value) => colourAt('viridis', (value - low) / (high - low || 1));
}

/** Ends of the scale of shaded points. @param {Part} part @returns {number[]} */
export const ownEnds = (part) => part.scale_ends ?? extent(part.shades);

/**
 * Points and ends of bars of a panel by x, each with its part and number; faint ones only where there are no others.
 * @param {Panel} panel
 * @returns {PartPoint[]}
 */
export function pointsOf(panel) {
  const known = panel.parts.filter((part) => part.kind === 'points' || part.kind === 'bars');
  const shown = (known.every((part) => part.is_faint) ? known : known.filter((part) => !part.is_faint)).map((part) => {
    if (part.kind === 'points') return part;
    const [x, y] = placed(part.along, part.lengths, part.places);
    return {...part, x, y, texts: []};
  });
  return shown
    .flatMap((part) => [.../** @type {number[]} */ (part.x).entries()].map(([at, x]) => ({part, at, x, y: part.y[at]})))
    .filter(({x, y}) => x !== null && y !== null)
    .sort((one, other) => one.x - other.x || one.y - other.y);
}

/**
 * A value with the label of its axis.
 * @param {Axis} axis
 * @param {number} value
 */
const said = (axis, value) => `${flat(axis.label)}: ${withUnit(value, axis)}`;

/** What is said of a point. @param {Panel} panel @param {{part: Part, at: number}} point @returns {string[]} */
export function pointText(panel, {part, at}) {
  const error = errors(part.y_error, at);
  const spread =
    error && (error[0] === error[1] ? ` ± ${short(error[0], 2)}` : ` −${short(error[0], 2)} +${short(error[1], 2)}`);
  return [
    part.texts?.[at] || part.label,
    said(panel.x, part.x[at]),
    said(panel.y, part.y[at]) + (spread ?? ''),
    part.sources?.[at] && `Source: ${part.sources[at]}`,
  ].filter(Boolean);
}

/**
 * Value of a curve at x; null beyond its ends or where it has several.
 * @param {Values} x
 * @param {Values} values
 * @param {number} at
 * @param {boolean} [isStepped]
 * @returns {number|null}
 */
function onCurve(x, values, at, isStepped) {
  const place = x.findIndex((end, after) => {
    const before = after > 0 ? x[after - 1] : null;
    return end !== null && before !== null && at >= before && at <= end;
  });
  if (place < 0) return null;
  const [low, high] = [values[place - 1], values[place]];
  if (low === null || high === null) return null;
  const [one, other] = /** @type {number[]} */ ([x[place - 1], x[place]]);
  return isStepped || other === one ? low : low + ((at - one) / (other - one)) * (high - low);
}

/** @param {Values} x @returns {boolean} */
const ascends = (x) =>
  x.every((value, at) => {
    const before = at > 0 ? x[at - 1] : null;
    return value === null || before === null || value >= before;
  });

/**
 * The point of a panel that is nearest to a place in pixels; undefined where none is near.
 * @param {Panel} panel
 * @param {Mapping} map
 * @param {number} left
 * @param {number} top
 * @param {number} scale
 * @returns {PartPoint|undefined}
 */
export const nearPoint = (panel, map, left, top, scale) =>
  pointsOf(panel)
    .map((point) => ({point, distance: Math.hypot(map.x.to(point.x) - left, map.y.to(point.y) - top)}))
    .filter(({distance}) => distance < NEAR * scale)
    .sort((one, other) => one.distance - other.distance)[0]?.point;

/**
 * Values of the parts of a panel at a place of its axes.
 * @param {Panel} panel
 * @param {number} x
 * @param {number} y
 * @returns {string[]}
 */
export function valuesAt(panel, x, y) {
  const place = [said(panel.x, x), said(panel.y, y)];
  const field = fieldOf(panel);
  if (field) {
    const value = readField(field, x, y);
    const text =
      value === null ? 'not known' : field.words ? field.words[Math.round(value)] : withUnit(value, {unit: field.unit});
    return [`${field.label || 'Value'}: ${text}`, ...place];
  }
  const texts = [];
  for (const part of panel.parts) {
    if (part.kind === 'line' && ascends(part.x)) {
      const value = onCurve(part.x, part.y, x, part.is_stepped);
      if (value !== null) texts.push(`${part.label || flat(panel.y.label)}: ${withUnit(value, panel.y)}`);
    } else if (part.kind === 'band') {
      const [low, high] = [onCurve(part.x, part.low, x), onCurve(part.x, part.high, x)];
      if (low !== null && high !== null) texts.push(`${part.label || 'range'}: ${short(low, 3)} to ${short(high, 3)}`);
    }
  }
  return texts.length ? [place[0], ...texts.reverse()] : place;
}
