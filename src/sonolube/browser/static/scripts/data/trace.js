/**
 * Channels of a recording over time: moved and zoomed by pointer, wheel and keys above a bar that shows where; parts of the recording
 * as handles. What is drawn while it moves is there already; a finer view is asked for meanwhile.
 *
 * @typedef {{id: string, kind: string, label: string, from: number, to: number, isFixed?: boolean}} Mark `isFixed` where the begin follows the recording
 */
import {html, useEffect, useLayoutEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {along, roundTicks, short, themeOf} from '../chart-scale.js';
import {Refusal, useEvents} from '../parts.js';

const [ROW, BAR, LEFT, RIGHT, BOTTOM, GAP] = [132, 46, 64, 10, 24, 12]; // px
const COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7'];
const [AROUND, COARSE] = [0.5, 4]; // shares of the window that are asked for beside it, and beyond which a view is too coarse
const EDGE = 8; // px at which the window of the bar is grasped to be widened
const FONT = '11.5px system-ui, sans-serif';
const ZOOM = 1.25;

/** Place of the first value not below another one, in increasing values. */
function bisect(values, value) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Views of a recording: of all of it, and of the window and what is beside it. */
function useViews(file, mapping, [from, to]) {
  const [{whole, near, failure}, setViews] = useState({});
  const [wanted, isAsking] = [useRef(null), useRef(false)];
  const view = (part) => ask('api/recording', {body: {file, ...(mapping && {mapping}), ...part}});
  useEffect(() => {
    view({}).then(({content, failure: fault}) => setViews({whole: content, failure: fault}));
  }, [file.upload, mapping]);
  const isThere = near && near.from <= from && near.to >= to && near.to - near.from <= COARSE * (to - from);
  const look = async () => {
    if (isAsking.current) return;
    isAsking.current = true;
    while (wanted.current) {
      const part = wanted.current;
      wanted.current = null;
      const {content} = await view(part);
      if (content) setViews((old) => ({...old, near: {...content, ...part}}));
    }
    isAsking.current = false;
  };
  useEffect(() => {
    if (!whole?.is_reduced || isThere) return;
    wanted.current = {from: from - AROUND * (to - from), to: to + AROUND * (to - from)};
    look();
  }, [from, to, Boolean(whole)]);
  return {whole, near, failure};
}

/** First and last place of a view that a window shows. */
const placesOf = ({x}, [from, to]) => [Math.max(bisect(x, from) - 1, 0), Math.min(bisect(x, to) + 1, x.length)];

/** Lowest and highest value of a channel in a window, with a margin. */
function endsOf(view, channel, range, margin) {
  const [first, last] = placesOf(view, range);
  let [low, high] = [Infinity, -Infinity];
  for (let k = first; k < last; k += 1) {
    const value = view.channels[channel][k];
    if (value !== null && value < low) low = value;
    if (value !== null && value > high) high = value;
  }
  if (low > high) return [0, 1];
  const room = margin * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low - room, high + room];
}

function drawLine(context, view, channel, range, x, y) {
  const [first, last] = placesOf(view, range);
  const values = view.channels[channel];
  let isDown = false;
  context.beginPath();
  for (let k = first; k < last; k += 1) {
    if (values[k] === null) isDown = false;
    else {
      context[isDown ? 'lineTo' : 'moveTo'](x.to(view.x[k]), y.to(values[k]));
      isDown = true;
    }
  }
  context.stroke();
}

/** Canvas of a size in px, cleared, with a context in px. */
function prepared(canvas, width, height) {
  const ratio = devicePixelRatio;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    Object.assign(canvas, {width: Math.round(width * ratio), height: Math.round(height * ratio)});
    Object.assign(canvas.style, {width: `${width}px`, height: `${height}px`});
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = FONT;
  return context;
}

/** Draw the channels one below the other over the window, with their axes. */
function draw(canvas, {views: {whole, near}, shown, channels, range, width, theme}) {
  const context = prepared(canvas, width, shown.length * (ROW + GAP) + BOTTOM);
  const x = along({}, range, LEFT, width - LEFT - RIGHT);
  const bottom = shown.length * (ROW + GAP) - GAP;
  const rule = (...ends) => {
    context.beginPath();
    context.moveTo(ends[0], ends[1]);
    context.lineTo(ends[2], ends[3]);
    context.stroke();
  };
  context.fillStyle = theme.muted;
  context.strokeStyle = theme.grid;
  context.textAlign = 'center';
  for (const tick of roundTicks(...range, Math.min(width / 90, 9))) {
    rule(x.to(tick), 0, x.to(tick), bottom);
    context.fillText(short(tick, 6), x.to(tick), bottom + 16);
  }
  shown.forEach((channel, row) => {
    const top = row * (ROW + GAP);
    const isFine = near && near.from <= range[0] && near.to >= range[1];
    const y = along({}, endsOf(isFine ? near : whole, channel, range, 0.06), top + ROW, -ROW);
    context.textAlign = 'right';
    context.fillStyle = theme.muted;
    context.strokeStyle = theme.grid;
    for (const tick of roundTicks(y.ends[0], y.ends[1], 4)) {
      rule(LEFT, y.to(tick), width - RIGHT, y.to(tick));
      context.fillText(short(tick, 4), LEFT - 6, y.to(tick) + 4);
    }
    context.textAlign = 'left';
    context.save();
    context.beginPath();
    context.rect(LEFT, top, width - LEFT - RIGHT, ROW);
    context.clip();
    context.strokeStyle = theme.stroke(COLOURS[channel % COLOURS.length]);
    if (!isFine) drawLine(context, whole, channel, range, x, y);
    if (near) drawLine(context, near, channel, range, x, y);
    context.restore();
    context.fillStyle = theme.surface;
    const {label, unit} = channels[channel];
    const text = unit ? `${label} [${unit}]` : label;
    context.globalAlpha = 0.8;
    context.fillRect(LEFT + 3, top + 3, context.measureText(text).width + 8, 17);
    context.globalAlpha = 1;
    context.fillStyle = theme.ink;
    context.fillText(text, LEFT + 7, top + 15);
  });
}

/** Handle at an end of a mark: a slider along the time. */
function Handle({mark, end, x, range, limits, unit, onMove}) {
  const {label, [end]: value} = mark;
  const move = (to, isMoving) => onMove(mark, end, Math.min(Math.max(to, limits[0]), limits[1]), isMoving);
  const drag = (event) => {
    if (event.type === 'pointerdown') event.target.setPointerCapture(event.pointerId);
    else if (!event.target.hasPointerCapture(event.pointerId)) return;
    event.stopPropagation();
    move(x.back(event.clientX - event.target.parentElement.getBoundingClientRect().left), event.type !== 'pointerup');
  };
  const press = (event) => {
    const step = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    move(value + step * (event.shiftKey ? 0.05 : 0.005) * (range[1] - range[0]), true);
  };
  if (value < range[0] || value > range[1]) return null;
  return html`<div role="slider" tabindex="0" class="trace-handle" style=${{left: `${x.to(value)}px`}} aria-label=${`${end === 'from' ? 'Begin' : 'End'} of ${label}`}
    aria-valuemin=${limits[0]} aria-valuemax=${limits[1]} aria-valuenow=${value} aria-valuetext=${`${short(value, 6)} ${unit}`.trim()} onPointerDown=${drag}
    onPointerMove=${drag} onPointerUp=${drag} onKeyDown=${press} onBlur=${() => onMove(mark, end, value, false)} data-test=${`handle:${mark.id}:${end}`}></div>`;
}

/**
 * @param {{file: object, mapping?: string, info: object, shown: number[], marks: Mark[], range: number[]|null, onRange: (range: number[]) => void,
 *   onMark: (mark: Mark, end: string, value: number, isMoving: boolean) => void}} props `range` is where the window was last, `onRange` is told when it rests
 */
export function Trace({file, mapping, info, shown, marks, range: given, onRange, onMark}) {
  const limits = [info.begin, info.end];
  const [range, setRange] = useState(given ?? limits);
  const [frame, figure, bar] = [useRef(null), useRef(null), useRef(null)];
  const [width, setWidth] = useState(0);
  const [theme, setTheme] = useState(null);
  const views = useViews(file, mapping, range);
  const {name, unit} = info.axis;
  const rest = useRef(0);
  useEvents(['themechange'], () => setTheme(themeOf(frame.current)));
  useEffect(() => setRange(given ?? limits), [String(given)]);
  useLayoutEffect(() => {
    setTheme(themeOf(frame.current));
    const observer = new ResizeObserver(() => setWidth(frame.current.clientWidth));
    observer.observe(frame.current);
    return () => observer.disconnect();
  }, []);
  const isReady = width > 0 && theme && views.whole;
  useLayoutEffect(() => {
    if (isReady) draw(figure.current, {views, shown, channels: info.channels, range, width, theme});
  }, [isReady, views.near, views.whole, range, width, theme, String(shown)]);
  const over = along({}, limits, 0, width);
  useLayoutEffect(() => {
    if (!isReady) return;
    const context = prepared(bar.current, width, BAR);
    context.strokeStyle = theme.stroke(COLOURS[shown[0] % COLOURS.length]);
    drawLine(context, views.whole, shown[0], limits, over, along({}, endsOf(views.whole, shown[0], limits, 0.06), BAR, -BAR));
  }, [isReady, views.whole, width, theme, shown[0]]);

  /** Show a window of a length about a place at a share of it. */
  const show = (from, length) => {
    const least = Math.max((limits[1] - limits[0]) / Math.max(info.samples, 1) * 8, Number.EPSILON);
    const long = Math.min(Math.max(length, least), limits[1] - limits[0]);
    const begin = Math.min(Math.max(from, limits[0]), limits[1] - long);
    setRange([begin, begin + long]);
    clearTimeout(rest.current);
    rest.current = setTimeout(() => onRange([begin, begin + long]), 400);
  };
  useEffect(() => () => clearTimeout(rest.current), []);
  const [length, middle] = [range[1] - range[0], (range[0] + range[1]) / 2];
  const zoom = (factor, about = middle) => show(about - (about - range[0]) * factor, length * factor);
  const press = (event) => {
    const steps = {
      ArrowLeft: () => show(range[0] - length / 10, length), ArrowRight: () => show(range[0] + length / 10, length),
      PageUp: () => show(range[0] - length, length), PageDown: () => show(range[0] + length, length),
      Home: () => show(limits[0], length), End: () => show(limits[1], length),
      '+': () => zoom(1 / ZOOM), '=': () => zoom(1 / ZOOM), '-': () => zoom(ZOOM), 0: () => show(limits[0], Infinity),
    };
    if (!steps[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    steps[event.key]();
  };
  const x = along({}, range, LEFT, Math.max(width - LEFT - RIGHT, 1));
  const held = useRef(null);
  const hold = (event, moved) => {
    if (event.button > 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    held.current = {at: event.clientX, range, moved};
  };
  const drag = (event) => held.current?.moved(event.clientX - held.current.at, held.current.range);
  const let_go = () => {
    held.current = null;
  };
  const pan = (event) => hold(event, (pixels, [from, to]) => show(from - (pixels * (to - from)) / (width - LEFT - RIGHT), to - from));
  const wheel = (event) => {
    event.preventDefault();
    const at = x.back(event.clientX - figure.current.getBoundingClientRect().left);
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) show(range[0] + ((event.deltaX || event.deltaY) / width) * length, length);
    else zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM, at);
  };
  useEffect(() => { // passive listeners, as the framework adds them, could not keep the page from scrolling
    const element = figure.current?.parentElement;
    element?.addEventListener('wheel', wheel, {passive: false});
    return () => element?.removeEventListener('wheel', wheel);
  });
  const grasp = (event) => {
    const at = event.clientX - bar.current.getBoundingClientRect().left;
    const [left, right] = range.map(over.to);
    const moved = (pixels) => (pixels / width) * (limits[1] - limits[0]);
    if (Math.abs(at - left) < EDGE) hold(event, (pixels, [from, to]) => show(Math.min(from + moved(pixels), to), to - Math.min(from + moved(pixels), to)));
    else if (Math.abs(at - right) < EDGE) hold(event, (pixels, [from, to]) => show(from, to - from + moved(pixels)));
    else {
      if (at < left || at > right) show(over.back(at) - length / 2, length);
      const from = at < left || at > right ? over.back(at) - length / 2 : range[0];
      hold(event, (pixels) => show(from + moved(pixels), length));
    }
  };
  const text = `${short(range[0], 6)} to ${short(range[1], 6)} ${unit}`.trim();
  const window_ = {role: 'slider', tabindex: 0, 'aria-valuemin': limits[0], 'aria-valuemax': limits[1], 'aria-valuenow': middle, 'aria-valuetext': text, onKeyDown: press};
  return html`<div class="trace" ref=${frame} data-test="trace" aria-busy=${!isReady && !views.failure}>
    <${Refusal} text=${views.failure?.text} role="alert" />
    <div class="trace-figure" ...${window_} aria-label=${`Recording over ${name}: arrows move, plus and minus zoom`} onPointerDown=${pan} onPointerMove=${drag} onPointerUp=${let_go}
      onDblClick=${() => show(limits[0], Infinity)} data-test="trace-figure"><canvas ref=${figure} /></div>
    ${isReady && html`<div class="trace-marks" role="group" aria-label="Parts of the recording" style=${{height: `${shown.length * (ROW + GAP) - GAP}px`}}>${marks.map((mark) => {
    const [left, right] = [mark.from, mark.to].map((value) => x.to(Math.min(Math.max(value, range[0]), range[1])));
    return html`<span key=${mark.id} class=${`trace-mark is-${mark.kind}`} style=${{left: `${left}px`, width: `${Math.max(right - left, 0)}px`}}>${right - left > 60 ? mark.label : ''}</span>
        ${!mark.isFixed && html`<${Handle} key=${`${mark.id}from`} mark=${mark} end="from" ...${{x, range, limits, unit}} onMove=${onMark} />`}
        <${Handle} key=${`${mark.id}to`} mark=${mark} end="to" ...${{x, range, limits, unit}} onMove=${onMark} />`;
  })}</div>`}
    <div class="trace-bar" ...${window_} aria-label="Part that is shown" onPointerDown=${grasp} onPointerMove=${drag} onPointerUp=${let_go} data-test="trace-bar"><canvas ref=${bar} />
      ${isReady && html`<span class="trace-window" style=${{left: `${over.to(range[0])}px`, width: `${Math.max(over.to(range[1]) - over.to(range[0]), 2)}px`}}></span>`}</div>
    <p class="hint" data-test="trace-shown">${text}${info.sample_rate ? `, ${short(info.sample_rate)} Hz` : ''}, ${info.samples} samples in all. Drag or arrows move, wheel or + and − zoom, 0 shows all.</p>
  </div>`;
}
