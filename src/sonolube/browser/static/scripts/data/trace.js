/**
 * Channels of a recording over time, moved and zoomed by pointer, wheel and keys above a bar that shows where; its
 * parts as handles. What is drawn while it moves is there already; a finer view is asked for meanwhile.
 *
 * @typedef {{id: string, kind: string, label: string, from: number, to: number, isFixed?: boolean}} Mark `isFixed`
 *   where only its end is moved
 */
import {html, useEffect, useLayoutEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {along, extent, roundTicks, short, themeOf} from '../chart-scale.js';
import {Refusal, useEvents} from '../parts.js';

const [ROW, BAR, LEFT, RIGHT, BOTTOM, GAP] = [132, 46, 64, 10, 24, 12]; // px
/** @type {Record<string, number>} */
const DIRECTIONS = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1};
const COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7'];
// shares of the window that are asked for beside it, and beyond which a view is too coarse
const [AROUND, COARSE] = [0.5, 4];
// factor of a step, samples of the shortest window, ms until it counts as at rest
const [ZOOM, LEAST, PAUSE] = [1.25, 8, 400];

/**
 * @import {Along, Theme, Values} from '../chart-scale.js'
 * @import {DataFile, Info} from './files.js'
 * @typedef {{from: number, to: number}} Window
 * @typedef {{x: number[], channels: Values[], is_reduced?: boolean}} Samples as they are drawn
 * @typedef {{whole?: Samples, near?: Samples & Window, failure?: import('../api.js').Failure}} Views
 * @typedef {(mark: Mark, end: 'from'|'to', value: number, isMoving: boolean) => void} OnMark
 */

/**
 * Views of a recording: of all of it, and of the window with what is beside it.
 * @param {DataFile} file
 * @param {string|undefined} mapping
 * @param {number[]} range
 * @returns {Views}
 */
function useViews(file, mapping, [from, to]) {
  const [{whole, near, failure}, setViews] = useState(/** @type {Views} */ ({}));
  const [wanted, isAsking] = [useRef(null), useRef(false)];
  /** @param {Partial<Window>} part */
  const view = (part) => ask('api/recording', {body: {file, ...(mapping && {mapping}), ...part}});
  useEffect(() => {
    view({}).then((reply) => setViews({whole: reply.content, failure: reply.failure}));
  }, [file.upload, mapping]);
  const look = async () => {
    if (isAsking.current) return;
    isAsking.current = true;
    for (let part = wanted.current; part; part = wanted.current) {
      wanted.current = null;
      const {content} = await view(part);
      if (content) setViews((old) => ({...old, near: {...content, ...part}}));
    }
    isAsking.current = false;
  };
  useEffect(() => {
    const isThere = near && near.from <= from && near.to >= to && near.to - near.from <= COARSE * (to - from);
    if (!whole?.is_reduced || isThere) return;
    wanted.current = {from: from - AROUND * (to - from), to: to + AROUND * (to - from)};
    look();
  }, [from, to, whole]);
  return {whole, near, failure};
}

/**
 * Times and values of a channel that a window shows, each with a neighbour.
 * @param {Samples} samples
 * @param {number} channel
 * @param {number[]} range
 * @returns {[number[], Values]}
 */
function pointsOf({x, channels}, channel, [from, to]) {
  const [first, last] = [x.findIndex((value) => value >= from), x.findIndex((value) => value > to)];
  const part = [Math.max((first < 0 ? x.length : first) - 1, 0), last < 0 ? x.length : last + 1];
  return [x.slice(...part), channels[channel].slice(...part)];
}

/**
 * Scale on which values fill a height up from its bottom, with a margin.
 * @param {Values} values
 * @param {number} bottom
 * @param {number} height
 */
function scaleOf(values, bottom, height) {
  const [low, high] = extent(values);
  if (low > high) return along({}, [0, 1], bottom, -height);
  const room = 0.06 * (high - low) || Math.abs(high) * 0.05 || 1;
  return along({}, [low - room, high + room], bottom, -height);
}

/** @param {CanvasRenderingContext2D} context @param {[number[], Values]} points @param {Along} x @param {Along} y */
function drawLine(context, [times, values], x, y) {
  let isDown = false;
  context.beginPath();
  values.forEach((value, at) => {
    if (value !== null) context[isDown ? 'lineTo' : 'moveTo'](x.to(times[at]), y.to(value));
    isDown = value !== null;
  });
  context.stroke();
}

/**
 * Context of a canvas of a size in px, cleared.
 * @param {HTMLCanvasElement} canvas
 * @param {number} width
 * @param {number} height
 */
function prepared(canvas, width, height) {
  Object.assign(canvas, {width: Math.round(width * devicePixelRatio), height: Math.round(height * devicePixelRatio)});
  Object.assign(canvas.style, {width: `${width}px`, height: `${height}px`});
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  context.scale(devicePixelRatio, devicePixelRatio);
  context.font = '11.5px system-ui, sans-serif';
  return context;
}

/**
 * Draw channels one below the other over the window, with their axes.
 * @param {HTMLCanvasElement} canvas
 * @param {Views & {whole: Samples}} views
 * @param {{shown: number[], channels: Info['channels'], range: number[], width: number, theme: Theme, x: Along}} how
 */
function draw(canvas, {whole, near}, {shown, channels, range, width, theme, x}) {
  const bottom = shown.length * (ROW + GAP) - GAP;
  const context = prepared(canvas, width, bottom + BOTTOM);
  /**
   * @param {string} text
   * @param {boolean} across
   * @param {number} left
   * @param {number} top
   * @param {number} wide
   * @param {number} high
   */
  const tick = (text, across, left, top, wide, high) => {
    context.fillStyle = theme.grid;
    context.fillRect(left, top, wide, high);
    context.textAlign = across ? 'center' : 'right';
    context.fillStyle = theme.muted;
    context.fillText(text, across ? left : left - 6, across ? high + 16 : top + 4);
  };
  for (const value of roundTicks(range[0], range[1], Math.min(width / 90, 9)))
    tick(short(value, 6), true, x.to(value), 0, 1, bottom);
  const isFine = near && near.from <= range[0] && near.to >= range[1];
  shown.forEach((channel, row) => {
    const top = row * (ROW + GAP);
    const points = pointsOf(isFine ? near : whole, channel, range);
    const y = scaleOf(points[1], top + ROW, ROW);
    for (const value of roundTicks(y.ends[0], y.ends[1], 4))
      tick(short(value), false, LEFT, y.to(value), width - LEFT - RIGHT, 1);
    context.save();
    context.beginPath();
    context.rect(LEFT, top, width - LEFT - RIGHT, ROW);
    context.clip();
    context.strokeStyle = theme.stroke(COLOURS[channel % COLOURS.length]);
    drawLine(context, points, x, y);
    context.restore();
    const text = `${channels[channel].label}${channels[channel].unit && ` [${channels[channel].unit}]`}`;
    Object.assign(context, {fillStyle: theme.surface, textAlign: 'left'});
    context.fillRect(LEFT + 3, top + 2, context.measureText(text).width + 8, 17);
    context.fillStyle = theme.ink;
    context.fillText(text, LEFT + 7, top + 15);
  });
}

/**
 * Properties of an element that is dragged: `begin` gives what is told of the pointer, and whether it still moves.
 * @param {(event: PointerEvent & {currentTarget: Element}) => (at: number, isMoving: boolean) => void} begin
 */
function useDrag(begin) {
  const held = useRef(/** @type {((at: number, isMoving: boolean) => void)|null} */ (null));
  return {
    /** @param {PointerEvent & {currentTarget: Element}} event */
    onPointerDown: (event) => {
      event.stopPropagation();
      event.currentTarget.setPointerCapture(event.pointerId);
      held.current = begin(event);
    },
    /** @param {PointerEvent} event */
    onPointerMove: (event) => held.current?.(event.clientX, true),
    /** @param {PointerEvent} event */
    onPointerUp: (event) => {
      held.current?.(event.clientX, false);
      held.current = null;
    },
  };
}

/**
 * Handle at an end of a mark: a slider along the time.
 * @param {{mark: Mark, end: 'from'|'to', x: Along, range: number[], unit: string, onMove: OnMark}} props
 */
function Handle({mark, end, x, range, unit, onMove}) {
  const {id, label, [end]: value} = mark;
  const drag = useDrag((event) => {
    const start = event.clientX - x.to(value);
    return (at, isMoving) => onMove(mark, end, x.back(at - start), isMoving);
  });
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    const step = DIRECTIONS[event.key];
    if (!step) return;
    event.preventDefault();
    onMove(mark, end, value + step * (event.shiftKey ? 0.05 : 0.005) * (range[1] - range[0]), true);
  };
  if (value < range[0] || value > range[1]) return null;
  return html`<div
    role="slider"
    tabindex="0"
    class=${`trace-handle is-${end} of-${mark.kind}`}
    style=${{left: `${x.to(value)}px`}}
    aria-valuenow=${value}
    aria-valuetext=${`${short(value, 6)} ${unit}`}
    aria-valuemin=${range[0]}
    aria-valuemax=${range[1]}
    aria-label=${`${end === 'from' ? 'Begin' : 'End'} of ${id}, ${label}`}
    ...${drag}
    onKeyDown=${press}
    onBlur=${() => onMove(mark, end, value, false)}
    data-test=${`handle:${id}:${end}`}
  ></div>`;
}

/**
 * @param {{file: DataFile, mapping?: string, info: Info, shown: number[], marks: Mark[], range: number[]|null, onRange:
 *   (range: number[]) => void, onMark: OnMark}} props
 *   `range` is where the window was last, `onRange` is told when it rests
 */
export function Trace({file, mapping, info, shown, marks, range: given, onRange, onMark}) {
  const limits = [info.begin, info.end];
  const [range, setRange] = useState(given ?? limits);
  const [width, setWidth] = useState(0);
  const [theme, setTheme] = useState(null);
  const [frame, figure, bar, rest] = [useRef(null), useRef(null), useRef(null), useRef(0)];
  const views = useViews(file, mapping, range);
  const x = along({}, range, LEFT, Math.max(width - LEFT - RIGHT, 1));
  const over = along({}, limits, 0, Math.max(width, 1));
  const isReady = width > 0 && theme && views.whole;
  useEvents(['themechange'], () => setTheme(themeOf(frame.current)));
  useEffect(() => setRange(given ?? limits), [String(given)]);
  useLayoutEffect(() => {
    setTheme(themeOf(frame.current));
    const observer = new ResizeObserver(() => setWidth(frame.current.clientWidth));
    observer.observe(frame.current);
    return () => observer.disconnect();
  }, []);
  useLayoutEffect(() => {
    const {whole} = views;
    if (whole && isReady)
      draw(figure.current, {...views, whole}, {shown, channels: info.channels, range, width, theme, x});
  }, [isReady, views.near, views.whole, range, width, theme, String(shown)]);
  useLayoutEffect(() => {
    if (!isReady || !views.whole) return;
    const context = prepared(bar.current, width, BAR);
    const points = pointsOf(views.whole, shown[0], limits);
    context.strokeStyle = theme.stroke(COLOURS[shown[0] % COLOURS.length]);
    drawLine(context, points, over, scaleOf(points[1], BAR, BAR));
  }, [isReady, views.whole, width, theme, shown[0]]);

  const [length, whole] = [range[1] - range[0], limits[1] - limits[0]];
  /** @param {number} from @param {number} long */
  const show = (from, long) => {
    const wide = Math.min(Math.max(long, (LEAST * whole) / info.samples), whole);
    const begin = Math.min(Math.max(from, limits[0]), limits[1] - wide);
    setRange([begin, begin + wide]);
    clearTimeout(rest.current);
    rest.current = setTimeout(() => onRange([begin, begin + wide]), PAUSE);
  };
  useEffect(() => () => clearTimeout(rest.current), []);
  /** @param {number} factor @param {number} [about] */
  const zoom = (factor, about = (range[0] + range[1]) / 2) =>
    show(about - (about - range[0]) * factor, length * factor);
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    /** @type {Record<string, () => void>} */
    const steps = {
      ArrowLeft: () => show(range[0] - length / 10, length),
      ArrowRight: () => show(range[0] + length / 10, length),
      PageUp: () => show(range[0] - length, length),
      PageDown: () => show(range[1], length),
      Home: () => show(limits[0], length),
      End: () => show(limits[1], length),
      '+': () => zoom(1 / ZOOM),
      '-': () => zoom(ZOOM),
      0: () => show(limits[0], whole),
    };
    const step = steps[event.key];
    if (!step || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    step();
  };
  const pan = useDrag((event) => (at) => show(range[0] - (x.back(at) - x.back(event.clientX)), length));
  const slide = useDrag(
    ({currentTarget}) =>
      (at) =>
        show(over.back(at - currentTarget.getBoundingClientRect().left) - length / 2, length),
  );
  /** @param {WheelEvent} event */
  const wheel = (event) => {
    event.preventDefault();
    if (event.shiftKey) show(range[0] + ((event.deltaX || event.deltaY) / width) * length, length);
    else zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM, x.back(event.clientX - frame.current.getBoundingClientRect().left));
  };
  const text = `${short(range[0], 6)} to ${short(range[1], 6)} ${info.axis.unit}`.trim();
  const slider = {
    role: 'slider',
    tabindex: 0,
    'aria-valuemin': limits[0],
    'aria-valuemax': limits[1],
    'aria-valuenow': range[0],
    'aria-valuetext': text,
    onKeyDown: press,
  };
  return html`<div class="trace" ref=${frame} data-test="trace" aria-busy=${!isReady && !views.failure}>
    <${Refusal} text=${views.failure?.text} role="alert" />
    <div
      class="trace-figure"
      ...${slider}
      aria-label=${`Channels over ${info.axis.label}: arrows move, plus and minus zoom`}
      ...${pan}
      onWheel=${wheel}
      data-test="trace-figure"
    >
      <canvas ref=${figure} />
    </div>
    <div
      class="trace-marks"
      role="group"
      aria-label="Parts of the recording"
      style=${{height: `${shown.length * (ROW + GAP) - GAP}px`}}
    >
      ${
        isReady &&
        marks.map((mark) => {
          const [left, right] = [mark.from, mark.to].map((value) =>
            x.to(Math.min(Math.max(value, range[0]), range[1])),
          );
          const [handle, wide] = [{mark, x, range, unit: info.axis.unit, onMove: onMark}, right - left];
          return html`
            <span
              key=${mark.id}
              class=${`trace-mark is-${mark.kind}`}
              style=${{left: `${left}px`, width: `${Math.max(wide, 0)}px`}}
            >
              ${wide > 60 ? mark.label : ''}
            </span>
            ${!mark.isFixed && html`<${Handle} key=${`${mark.id}<`} end="from" ...${handle} />`}
            <${Handle} key=${`${mark.id}>`} end="to" ...${handle} />
          `;
        })
      }
    </div>
    <div class="trace-bar" ...${slider} aria-label="Part that is shown" ...${slide} data-test="trace-bar">
      <canvas ref=${bar} />
      <span
        class="trace-window"
        style=${{left: `${over.to(range[0])}px`, width: `${over.to(range[1]) - over.to(range[0])}px`}}
      ></span>
    </div>
    <p class="hint" data-test="trace-shown">
      ${text}
      ${info.sample_rate ? `, ${short(info.sample_rate)} Hz` : ''}, ${info.samples} samples in all. Drag or arrows move,
      wheel or + and − zoom, 0 shows all.
    </p>
  </div>`;
}
