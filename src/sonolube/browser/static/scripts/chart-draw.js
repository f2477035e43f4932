/** Parts of a panel drawn on its canvas, in the order in which they are given. */
import {colourAt, drawField, readField, scaleOf} from './chart-field.js';
import {css, dash, errors, short, withUnit} from './chart-scale.js';

const LINE = 1.7; // px
const MARKER = 3.6; // px, half of its width
const NEAR = 16; // px from a point within which it is read
/** Markers of unit size about zero, as paths of SVG. */
export const MARKERS = [
  'M-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0Z', 'M-.9-.9H.9V.9H-.9Z', 'M0-1.1 1 .9H-1Z', 'M0-1.25 1.25 0 0 1.25-1.25 0Z', 'M0 1.1 1-.9H-1Z',
  'M-.4-1.2H.4V-.4H1.2V.4H.4V1.2H-.4V.4H-1.2V-.4H-.4Z', 'M-1.1-.6-.6-1.1 0-.5.6-1.1 1.1-.6.5 0 1.1.6.6 1.1 0 .5-.6 1.1-1.1.6-.5 0Z',
  'M-1.1 0 .9-1V1Z', 'M1.1 0-.9-1V1Z', 'M0-1.4.33-.45 1.33-.43.53.17.82 1.13 0 .56-.82 1.13-.53.17-1.33-.43-.33-.45Z',
];

/**
 * Places of values on a canvas and back.
 * @param {{left: number, top: number, width: number, height: number}} box in pixels of the canvas
 */
export function mapping(panel, ranges, box) {
  const axis = (name, start, length) => {
    const [to, from] = panel[name].logarithmic ? [Math.log10, (value) => 10 ** value] : [(value) => value, (value) => value];
    const [low, high] = ranges[name].map(to);
    return {
      ends: ranges[name], to: (value) => start + ((to(value) - low) / (high - low)) * length,
      back: (place) => from(low + ((place - start) / length) * (high - low)),
    };
  };
  return {box, x: axis('x', box.left, box.width), y: axis('y', box.top + box.height, -box.height)};
}

/** Pixels of a curve; null where it is interrupted. */
function pixels(line, map) {
  return line.x.map((x, at) => {
    const place = x === null || line.y[at] === null ? null : [map.x.to(x), map.y.to(line.y[at])];
    return place && Number.isFinite(place[0]) && Number.isFinite(place[1]) ? place : null;
  });
}

function trace(context, places, isStepped) {
  context.beginPath();
  let before = null;
  for (const place of places) {
    if (place && before) {
      if (isStepped) context.lineTo(place[0], before[1]);
      context.lineTo(...place);
    } else if (place) context.moveTo(...place);
    before = place;
  }
}

/**
 * Draws the parts of a panel.
 * @param {CanvasRenderingContext2D} context
 * @param {Object} panel
 * @param {{map: Object, theme: Object, scale: number, behind: Object[], rule: Object|null, held: number|null}} of
 *   `behind` are kept lines; `held` is where the dragged `rule` stands, null where its data say it
 */
export function drawParts(context, panel, {map, theme, scale, behind, rule: dragged, held}) {
  const draw = {line, band, points, rule, zone, bars, note, field: (part) => drawField(context, part, map, scale)};
  const {left, top, width, height} = map.box;
  const inside = (work) => {
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    work();
    context.restore();
  };
  const order = (part) => ({zone: 0, field: 1, band: 2, points: part.is_faint ? 1 : 4, note: 5}[part.kind] ?? 3);
  const each = (part) => {
    if (part.kind === 'points' || part.kind === 'note') draw[part.kind](part);
    else inside(() => draw[part.kind](part));
  };
  const parts = [...panel.parts].sort((one, other) => order(one) - order(other));
  parts.filter((part) => order(part) < 3).forEach(each);
  behind.forEach((part, at) => inside(() => line({...part, dash: at, weight: 0.9}, theme.kept)));
  parts.filter((part) => order(part) >= 3).forEach(each);

  function line(part, colour = theme.stroke(part.colour)) {
    const places = pixels(part, map);
    context.lineJoin = 'round';
    trace(context, places, part.is_stepped);
    if (part.has_halo) {
      context.strokeStyle = 'white';
      context.lineWidth = (LINE * (part.weight ?? 1) + 2) * scale;
      context.stroke();
    }
    context.strokeStyle = part.has_halo ? css([20, 20, 20]) : colour;
    context.lineWidth = LINE * (part.weight ?? 1) * scale;
    context.setLineDash(dash(part.dash).map((length) => length * scale));
    context.stroke();
    context.setLineDash([]);
    if (part.marker == null) return;
    places.filter(Boolean).forEach((place) => mark(part.marker, 0.8 * MARKER * scale, place, colour));
  }

  function mark(marker, size, [x, y], colour, {isHollow = false, edge = theme.surface} = {}) {
    const path = new Path2D(MARKERS[(marker ?? 0) % MARKERS.length]);
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

  function band(part) {
    const known = part.x.map((x, at) => at).filter((at) => part.x[at] !== null && part.low[at] !== null && part.high[at] !== null);
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
    context.globalAlpha = part.opacity ?? 0.25;
    context.fillStyle = theme.fill(part.colour);
    context.fill();
    context.globalAlpha = 1;
  }

  function points(part) {
    const colour = theme.stroke(part.colour);
    const size = (part.is_faint ? 0.4 : part.shades ? 1.3 * Math.sqrt(part.size ?? 1) : part.size ?? 1) * MARKER * scale;
    const shade = part.shades && shadeOf(part, panel);
    part.x.forEach((x, at) => {
      if (x === null || part.y[at] === null) return;
      const place = [map.x.to(x), map.y.to(part.y[at])];
      inside(() => {
        bar(errors(part.y_error, at), part.y[at], place, 'y', colour);
        bar(errors(part.x_error, at), x, place, 'x', colour);
      });
      context.globalAlpha = part.is_faint ? 0.6 : 1;
      mark(part.marker, size, place, shade ? css(shade(part.shades[at])) : colour, {isHollow: part.is_hollow, edge: part.is_faint ? colour : shade ? 'white' : theme.surface});
      context.globalAlpha = 1;
      if (part.texts?.[at]) write(part.texts[at], place[0] + 7 * scale, place[1], 'left', theme.ink, true);
    });
  }

  function bar(lengths, value, [x, y], name, colour) {
    if (!lengths) return;
    const [one, other] = [map[name].to(value - lengths[0]), map[name].to(value + lengths[1])];
    const cap = 2.5 * scale;
    context.beginPath();
    for (const end of [one, other]) {
      if (name === 'y') context.rect(x - cap, end, 2 * cap, 0);
      else context.rect(end, y - cap, 0, 2 * cap);
    }
    context.moveTo(...(name === 'y' ? [x, one] : [one, y]));
    context.lineTo(...(name === 'y' ? [x, other] : [other, y]));
    context.strokeStyle = colour;
    context.lineWidth = scale;
    context.stroke();
  }

  function rule(part) {
    const value = held !== null && part === dragged ? held : part.value;
    const place = map[part.along ?? 'x'].to(value);
    context.beginPath();
    if ((part.along ?? 'x') === 'x') {
      context.moveTo(place, top);
      context.lineTo(place, top + height);
    } else {
      context.moveTo(left, place);
      context.lineTo(left + width, place);
    }
    context.strokeStyle = theme.stroke(part.colour);
    context.lineWidth = 1.1 * scale;
    context.setLineDash(dash(part.dash ?? 3).map((length) => length * scale));
    context.stroke();
    context.setLineDash([]);
  }

  function zone(part) {
    context.globalAlpha = part.opacity ?? 1;
    context.fillStyle = theme.fill(part.colour);
    part.first.forEach((first, at) => {
      const [one, other] = [map[part.along].to(first), map[part.along].to(part.last[at])];
      if (part.along === 'x') context.fillRect(one, top, other - one, height);
      else context.fillRect(left, other, width, one - other);
    });
    context.globalAlpha = 1;
  }

  function bars(part) {
    const along = part.along ?? 'x';
    const across = along === 'x' ? 'y' : 'x';
    const half = (part.breadth ?? 0.6) / 2;
    context.fillStyle = theme.stroke(part.colour);
    part.places.forEach((place, at) => {
      const length = part.lengths[at];
      if (length === null) return;
      const [from, to] = [map[along].to(map[along].ends[0] > 0 ? map[along].ends[0] : 0), map[along].to(length)];
      const [one, other] = [map[across].to(place - half), map[across].to(place + half)];
      if (along === 'x') context.fillRect(from, other, to - from, one - other);
      else context.fillRect(one, to, other - one, from - to);
      const middle = map[across].to(place);
      const lengths = errors(part.error, at);
      bar(lengths, length, along === 'x' ? [to, middle] : [middle, to], along, theme.ink);
      const end = lengths ? map[along].to(length + lengths[1]) : to;
      if (part.texts?.[at] && along === 'x') write(part.texts[at], end + 4 * scale, middle, 'left', theme.ink);
      else if (part.texts?.[at]) write(part.texts[at], middle, end - 8 * scale, 'center', theme.ink);
    });
  }

  function note(part) {
    const [x, y] = [map.x.to(part.x), map.y.to(part.y)];
    const [shift, align, rise] = {right: [6, 'left', 0], left: [-6, 'right', 0], above: [0, 'center', -9]}[part.side ?? 'right'];
    write(part.text, x + shift * scale, y + rise * scale, align, theme.stroke(part.colour));
  }

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

/** Colours of shaded points: those of the field below them, or of a scale of their own. */
export function shadeOf(part, panel) {
  const below = panel.parts.find((each) => each.kind === 'field');
  if (below) return scaleOf(below).colour;
  const {ends: [low, high]} = ownScale(part);
  return (value) => colourAt('viridis', (value - low) / (high - low || 1));
}

/** The scale of shaded points as that of a field. */
export function ownScale(part) {
  if (part.scale_ends) return {ends: part.scale_ends};
  const known = part.shades.filter((value) => value !== null);
  return {ends: [Math.min(...known), Math.max(...known)]};
}

/** Points and ends of bars of a panel by x, each with its part and number. */
export function pointsOf(panel) {
  const found = panel.parts.filter((part) => part.kind === 'points' || part.kind === 'bars').map((part) => {
    const [x, y] = (part.along ?? 'x') === 'x' ? [part.lengths, part.places] : [part.places, part.lengths];
    return part.kind === 'bars' ? {...part, x, y, texts: []} : part;
  }).flatMap((part) => part.x.map((x, at) => ({part, at, x, y: part.y[at]})));
  return found.filter(({x, y}) => x !== null && y !== null).sort((one, other) => one.x - other.x || one.y - other.y);
}

/** What is said of a point. */
export function pointText(panel, {part, at}) {
  const error = errors(part.y_error, at);
  const spread = error && (error[0] === error[1] ? ` ± ${short(error[0], 2)}` : ` −${short(error[0], 2)} +${short(error[1], 2)}`);
  return [
    part.texts?.[at] || part.label,
    `${panel.x.label.replaceAll('\n', ' ')}: ${withUnit(part.x[at], panel.x)}`,
    `${panel.y.label.replaceAll('\n', ' ')}: ${withUnit(part.y[at], panel.y)}${spread || ''}`,
    part.sources?.[at] && `Source: ${part.sources[at]}`,
  ].filter(Boolean);
}

/** Value of a curve at x; null beyond its ends or where it has several. */
function onCurve(x, values, at, isStepped) {
  for (let place = 1; place < x.length; place += 1) {
    const [one, other] = [x[place - 1], x[place]];
    if (one === null || other === null || at < one || at > other) continue;
    const [low, high] = [values[place - 1], values[place]];
    if (low === null || high === null) return null;
    return isStepped || other === one ? low : low + ((at - one) / (other - one)) * (high - low);
  }
  return null;
}

const ascends = (x) => x.every((value, at) => !at || value === null || x[at - 1] === null || value >= x[at - 1]);

/** What is said of a place of a panel in pixels: of the nearest point, else of the values there. */
export function readAt(panel, map, left, top, scale) {
  const near = pointsOf(panel).map((point) => [Math.hypot(map.x.to(point.x) - left, map.y.to(point.y) - top), point])
    .filter(([distance]) => distance < NEAR * scale).sort(([one], [other]) => one - other)[0];
  return near ? pointText(panel, near[1]) : valuesAt(panel, map.x.back(left), map.y.back(top));
}

/** Values of the parts of a panel at a place of its axes. */
export function valuesAt(panel, x, y) {
  const [across, up] = [panel.x, panel.y].map((axis) => axis.label.replaceAll('\n', ' '));
  const field = panel.parts.find((part) => part.kind === 'field');
  if (field) {
    const value = readField(field, x, y);
    const text = field.words ? field.words[Math.round(value)] : withUnit(value, field);
    return [`${field.label || 'Value'}: ${value === null ? 'not known' : text}`, `${across}: ${withUnit(x, panel.x)}`, `${up}: ${withUnit(y, panel.y)}`];
  }
  const texts = [];
  for (const part of panel.parts) {
    if (part.kind === 'line' && ascends(part.x)) {
      const value = onCurve(part.x, part.y, x, part.is_stepped);
      if (value !== null) texts.push(`${part.label || up}: ${withUnit(value, panel.y)}`);
    } else if (part.kind === 'band') {
      const [low, high] = [onCurve(part.x, part.low, x), onCurve(part.x, part.high, x)];
      if (low !== null && high !== null) texts.push(`${part.label || 'range'}: ${short(low, 3)} to ${short(high, 3)}`);
    }
  }
  return texts.length ? [`${across}: ${withUnit(x, panel.x)}`, ...texts.reverse()] : [`${across}: ${withUnit(x, panel.x)}`, `${up}: ${withUnit(y, panel.y)}`];
}
