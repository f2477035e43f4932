/** One panel of a chart: axes by uPlot, parts by `drawParts`; reading by pointer and keys, picking, a rule to drag. */
import {html, useEffect, useLayoutEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import uPlot from '../vendor/uplot-1.6.32.js';
import {drawParts, mapping, pointsOf, pointText, readAt, valuesAt} from './chart-draw.js';
import {tickTexts, ticksOf, withUnit} from './chart-scale.js';

const FONT = '11.5px system-ui, sans-serif';
const [NUMBER_HEIGHT, NUMBER_WIDTH] = [34, 50]; // px that a number takes along an axis
const STEPS = 50; // of the arrow keys over an axis
const RULE_STEPS = 400; // of the rule that is dragged
const THUMB = 28; // px that it can be grasped at, as in the style
const MOVED = 4; // px beyond which a press is no click

/** What must be made anew, rather than given new data. */
const structureOf = ({x, y}) => JSON.stringify([x, y].map((axis) => [axis.text, axis.logarithmic, axis.words, axis.reciprocal, axis.proportional, axis.lowest > axis.highest]));

const flat = (text) => text.replaceAll('\n', ' ');
export const panelName = (panel) => [panel.title, `${flat(panel.y.text)} over ${flat(panel.x.text)}`].filter(Boolean).join(': ');

/** Options of uPlot; everything that changes is read from `latest`. */
function optionsOf(latest) {
  const now = () => latest.current;
  const scale = (name) => ({
    time: false, distr: now().panel[name].logarithmic ? 3 : 1, log: 10, dir: now().ranges[name][0] > now().ranges[name][1] ? -1 : 1,
    range: () => [...now().ranges[name]].sort((one, other) => one - other),
  });
  const axis = (name) => ({
    scale: name, font: FONT, labelFont: FONT, stroke: () => now().theme.muted,
    grid: {stroke: () => now().theme.grid, width: 1, show: !now().panel.parts.some((part) => part.kind === 'field')},
    ticks: {stroke: () => now().theme.grid, size: 4, width: 1},
    border: {show: true, stroke: () => now().theme.kept, width: 1},
    splits: (u) => {
      const length = (name === 'x' ? u.bbox.width : u.bbox.height) / devicePixelRatio;
      return ticksOf(now().panel[name], now().ranges[name], length / (name === 'x' ? NUMBER_WIDTH : NUMBER_HEIGHT));
    },
    filter: (u, splits) => splits,
    values: (u, splits) => tickTexts(now().panel[name], splits),
  });
  const axes = [
    {...axis('x'), label: now().hasXText ? flat(now().panel.x.text) : undefined, labelSize: 18, labelGap: 0,
      size: 15 + 13 * Math.max(1, ...(now().panel.x.words ?? []).map((word) => word.split('\n').length))},
    {...axis('y'), size: (u, values) => 14 + 6.6 * Math.max(2, ...(values ?? []).map((text) => text.length))},
  ];
  for (const [name, side] of [['x', 0], ['y', 1]]) {
    const {reciprocal, proportional} = now().panel[name];
    const [constant, label] = reciprocal ?? proportional ?? [];
    if (label === undefined) continue;
    const other = (value) => (reciprocal ? constant / value : constant * value);
    axes.push({...axis(name), side, grid: {show: false}, size: name === 'x' ? 24 : 44, label, labelSize: 18, values: (u, splits) => tickTexts({}, splits.map(other))});
  }
  return {
    width: now().width, height: now().height, scales: {x: scale('x'), y: scale('y')}, axes,
    series: [{}, {scale: 'y', paths: () => null, points: {show: false}}],
    legend: {show: false}, padding: [8, 14, 2, 0],
    cursor: {drag: {x: false, y: false, setScale: false}, points: {show: false}, focus: {prox: -1}},
    hooks: {draw: [(u) => now().draw(u)]},
  };
}

/** Step along an axis by shares of its length. */
function stepped(axis, [low, high], value, share) {
  const [to, from] = axis.logarithmic ? [Math.log, Math.exp] : [(each) => each, (each) => each];
  const next = to(value) + share * (to(high) - to(low));
  return from(Math.min(Math.max(next, Math.min(to(low), to(high))), Math.max(to(low), to(high))));
}

/** Share of the length of an axis at which a value stands. */
function shareOf(axis, [low, high], value) {
  const to = axis.logarithmic ? Math.log : (each) => each;
  return (to(value) - to(low)) / (to(high) - to(low));
}

const middle = (axis, ends) => stepped(axis, ends, ends[0], 0.5);

/**
 * @param {{panel: Object, place: number, ranges: {x: number[], y: number[]}, behind: Object[], width: number, height: number,
 *   hasXText: boolean, theme: Object, drag?: Object, onPick?: Function, say: (text: string) => void}} props
 */
export function ChartPanel(props) {
  const {panel, place, behind, width, height, hasXText, theme, drag, onPick, say} = props;
  const [host, handle, plot] = [useRef(null), useRef(null), useRef(null)];
  const latest = useRef(null);
  const [tip, setTip] = useState(null);
  const [held, setHeld] = useState(null);
  const [at, grabbed, pressed] = [useRef(null), useRef(null), useRef(null)];
  const ranges = grabbed.current ?? props.ranges; // an axis that follows the rule stands still under the pointer
  const rule = drag ? panel.parts.find((part) => part.kind === 'rule' && (part.along ?? 'x') === 'x') : null;

  const mapOf = (u) => mapping(panel, ranges, u.bbox);
  latest.current = {
    ...props, ranges, draw: (u) => {
      const map = mapOf(u);
      drawParts(u.ctx, panel, {map, theme, scale: devicePixelRatio, behind, rule, held});
      if (!handle.current || !rule) return;
      const [left, top, length, high] = [map.box.left, map.box.top, map.box.width, map.box.height].map((each) => each / devicePixelRatio);
      Object.assign(handle.current.style, {left: `${left - THUMB / 2}px`, top: `${top}px`, width: `${length + THUMB}px`, height: `${high}px`});
    },
  };

  const structure = structureOf(panel) + hasXText;
  useLayoutEffect(() => {
    plot.current = new uPlot(optionsOf(latest), [ranges.x, ranges.y], host.current);
    return () => {
      plot.current.destroy();
      plot.current = null;
    };
  }, [structure]);
  useLayoutEffect(() => {
    const u = plot.current;
    if (u.width !== width || u.height !== height) u.setSize({width, height});
    u.setData([ranges.x, ranges.y]);
  }, [panel, ranges, behind, width, height, theme]);
  useLayoutEffect(() => plot.current.redraw(false), [held]);
  useEffect(() => {
    if (!grabbed.current) setHeld(null);
    setTip((old) => (old?.isKept ? old : null));
  }, [panel]);

  /** Place of a pointer in pixels of the canvas, and in the axes; null beyond them. */
  const placeOf = (event) => {
    const box = host.current.getBoundingClientRect();
    const map = mapOf(plot.current);
    const [left, top] = [event.clientX - box.left, event.clientY - box.top].map((each) => each * devicePixelRatio);
    const isIn = left >= map.box.left && left <= map.box.left + map.box.width && top >= map.box.top && top <= map.box.top + map.box.height;
    return {map, left, top, isIn, x: map.x.back(left), y: map.y.back(top)};
  };
  const showTip = (map, left, top, texts, isKept = false) => {
    setTip({left: left / devicePixelRatio, top: top / devicePixelRatio, texts, isKept});
    plot.current.setCursor({left: (left - map.box.left) / devicePixelRatio, top: (top - map.box.top) / devicePixelRatio}, false);
  };
  const hide = () => {
    setTip(null);
    plot.current?.setCursor({left: -10, top: -10}, false);
  };
  const hover = (event) => {
    const {map, left, top, isIn} = placeOf(event);
    if (!isIn) return hide();
    at.current = {x: map.x.back(left), y: map.y.back(top), number: at.current?.number ?? -1};
    return showTip(map, left, top, readAt(panel, map, left, top, devicePixelRatio));
  };
  const pick = (event) => {
    const start = pressed.current;
    if (!onPick || (start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) > MOVED)) return;
    const {isIn, x, y} = placeOf(event);
    if (isIn) onPick({panel: place, x, y});
  };

  /** Arrow keys read values, up and down where there are no points, else point after point. */
  const press = (event) => {
    const {key} = event;
    const points = pointsOf(panel);
    const isField = panel.parts.some((part) => part.kind === 'field');
    const now = at.current ?? {x: rule?.value ?? middle(panel.x, ranges.x), y: middle(panel.y, ranges.y), number: -1};
    const map = mapOf(plot.current);
    const size = (event.shiftKey ? 10 : 1) / STEPS;
    let texts;
    if (key === 'ArrowLeft' || key === 'ArrowRight') {
      at.current = {...now, x: stepped(panel.x, ranges.x, now.x, key === 'ArrowLeft' ? -size : size)};
    } else if ((key === 'ArrowUp' || key === 'ArrowDown') && points.length && !isField) {
      const number = (now.number + (key === 'ArrowDown' ? 1 : points.length - 1 + (now.number < 0))) % points.length;
      at.current = {x: points[number].x, y: points[number].y, number};
      texts = pointText(panel, points[number]);
    } else if (key === 'ArrowUp' || key === 'ArrowDown') {
      at.current = {...now, y: stepped(panel.y, ranges.y, now.y, key === 'ArrowDown' ? -size : size)};
    } else if (key === 'Escape') {
      hide();
      return;
    } else if ((key === 'Enter' || key === ' ') && onPick) {
      event.preventDefault();
      onPick({panel: place, x: now.x, y: now.y});
      return;
    } else return;
    event.preventDefault();
    const {x, y} = at.current;
    texts ??= valuesAt(panel, x, y);
    showTip(map, map.x.to(x), map.y.to(y), texts, true);
    say(texts.join('; '));
  };

  const share = (value) => Math.round(RULE_STEPS * shareOf(panel.x, ranges.x, value));
  const move = (event) => {
    grabbed.current ??= props.ranges;
    const value = stepped(panel.x, ranges.x, ranges.x[0], event.target.value / RULE_STEPS);
    setHeld(value);
    drag.onMove?.(value);
  };
  const release = (event) => {
    grabbed.current = null;
    drag.onRelease?.(stepped(panel.x, ranges.x, ranges.x[0], event.target.value / RULE_STEPS));
  };

  const value = rule && (held ?? rule.value);
  const hint = `Arrow keys read values${pointsOf(panel).length ? ', up and down the points' : ''}${onPick ? ', Enter sets the rig' : ''}.`;
  return html`<div class="chart-frame">
    <div ref=${host} class=${`chart-plot${onPick ? ' is-pickable' : ''}`} role="img" tabindex="0" data-test=${`plot:${place}`}
      aria-label=${`${panelName(panel)}. ${hint}`} onPointerMove=${hover} onPointerLeave=${hide} onKeyDown=${press} onBlur=${hide}
      onPointerDown=${(event) => { pressed.current = [event.clientX, event.clientY]; hover(event); }} onClick=${pick}></div>
    ${rule && html`<input ref=${handle} type="range" class="chart-handle" min="0" max=${RULE_STEPS} value=${share(value)} aria-valuetext=${withUnit(value, panel.x)}
      aria-label=${`${rule.label || 'Value'}, ${flat(panel.x.label)}`} data-test=${`drag:${place}`} onInput=${move} onChange=${release} onPointerDown=${hide} />`}
    ${tip && html`<div class=${`chart-tip${tip.left > width / 2 ? ' is-left' : ''}${tip.top > height / 2 ? ' is-above' : ''}`}
      style=${{left: `${tip.left}px`, top: `${tip.top}px`, maxWidth: `${Math.max(150, Math.max(tip.left, width - tip.left) - 16)}px`}}
      aria-hidden="true" data-test="tip">
      ${tip.texts.map((text, number) => html`<div key=${number}>${text}</div>`)}</div>`}
  </div>`;
}
