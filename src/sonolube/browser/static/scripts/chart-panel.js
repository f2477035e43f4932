/** One panel of a chart: axes by uPlot, parts by `drawParts`; reading by pointer and keys, picking, a rule to drag. */
import {html, useEffect, useLayoutEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import uPlot from '../vendor/uplot-1.6.32.js';
import {drawParts, mapping, nearPoint, pointsOf, pointText, valuesAt} from './chart-draw.js';
import {along, fieldOf, flat, isReversed, tickTexts, ticksOf, withUnit} from './chart-scale.js';

/**
 * @import {PartPoint} from './chart-draw.js'
 * @import {Mapping} from './chart-field.js'
 * @import {Axis, Name, Panel, Part, Ranges, Theme} from './chart-scale.js'
 * @import {FieldEvent} from './parts.js'
 * @typedef {{panel: number, onMove: (x: number) => void, onRelease: (x: number) => void}} Drag of the rule of a panel
 * @typedef {(place: {panel: number, x: number, y: number}) => void} OnPick
 * @typedef {(panel: Panel, ranges: Ranges) => any} Over gives what lies over the area between the axes of a panel
 * @typedef {{panel: Panel, place: number, ranges: Ranges, behind: Part[], width: number, height: number, hasXText:
 *   boolean, theme: Theme, drag?: Drag, over?: Over, onPick?: OnPick, picks?: string, onRead?: (point: PartPoint|null)
 *   => void, ringed?: {x: number, y: number}, say: (text: string) => void}} PanelProps `onRead` is told the point that
 *   is read, null where none is
 * @typedef {{x: number, y: number, number: number}} ReadPlace where the keys read, and the number of the point there
 */

const FONT = '12px system-ui, sans-serif'; // uPlot scales whole pixels only
/** @type {Name[]} */
const AXES = ['x', 'y'];
const [NUMBER_HEIGHT, NUMBER_WIDTH] = [34, 50]; // px that a number takes along an axis
const STEPS = 50; // of the arrow keys over an axis
const RULE_STEPS = 400; // of the rule that is dragged
const THUMB = 28; // px that it can be grasped at, as in the style
const MOVED = 4; // px beyond which a press is no click

/**
 * What must be made anew, rather than given new data.
 * @param {Panel} panel
 */
const structureOf = ({x, y}) =>
  JSON.stringify(
    [x, y].map((axis) => [
      axis.text,
      axis.logarithmic,
      axis.words,
      axis.reciprocal,
      axis.proportional,
      isReversed(axis),
    ]),
  );

/** @param {Panel} panel @returns {string} */
export const panelName = (panel) =>
  [panel.title, `${flat(panel.y.text)} over ${flat(panel.x.text)}`].filter(Boolean).join(': ');

/**
 * Options of uPlot; everything that changes is read from `latest`.
 * @param {import('../vendor/htm-preact-3.1.1.js').Ref<PanelProps & {draw: (plot: uPlot) => void}>} latest
 */
function optionsOf(latest) {
  const now = () => latest.current;
  /** @param {Name} name */
  const scale = (name) => ({
    time: false,
    distr: now().panel[name].logarithmic ? 3 : 1,
    log: 10,
    dir: now().ranges[name][0] > now().ranges[name][1] ? -1 : 1,
    range: () => [...now().ranges[name]].sort((one, other) => one - other),
  });
  /** @param {Name} name */
  const axis = (name) => ({
    scale: name,
    font: FONT,
    labelFont: FONT,
    stroke: () => now().theme.muted,
    grid: {stroke: () => now().theme.grid, width: 1, show: !fieldOf(now().panel)},
    ticks: {stroke: () => now().theme.grid, size: 4, width: 1},
    border: {show: true, stroke: () => now().theme.kept, width: 1},
    /** @param {uPlot} u */
    splits: (u) => {
      const length = (name === 'x' ? u.bbox.width : u.bbox.height) / devicePixelRatio;
      return ticksOf(now().panel[name], now().ranges[name], length / (name === 'x' ? NUMBER_WIDTH : NUMBER_HEIGHT));
    },
    /** @param {uPlot} u @param {number[]} splits */
    filter: (u, splits) => splits,
    /** @param {uPlot} u @param {number[]} splits */
    values: (u, splits) => tickTexts(now().panel[name], splits),
  });
  /** @type {object[]} */
  const axes = [
    {
      ...axis('x'),
      label: now().hasXText ? flat(now().panel.x.text) : undefined,
      labelSize: 18,
      labelGap: 0,
      size: 15 + 13 * Math.max(1, ...(now().panel.x.words ?? []).map((word) => word.split('\n').length)),
    },
    {
      ...axis('y'),
      /** @param {uPlot} u @param {string[]} [values] */
      size: (u, values) => 14 + 6.6 * Math.max(2, ...(values ?? []).map((text) => text.length)),
    },
  ];
  for (const [side, name] of AXES.entries()) {
    const {reciprocal, proportional} = now().panel[name];
    const second = reciprocal ?? proportional;
    if (!second) continue;
    const [constant, label] = second;
    /** @param {number} value */
    const other = (value) => (reciprocal ? constant / value : constant * value);
    axes.push({
      ...axis(name),
      side,
      grid: {show: false},
      size: name === 'x' ? 24 : 44,
      label,
      labelSize: 18,
      /** @param {uPlot} u @param {number[]} splits */
      values: (u, splits) => tickTexts({}, splits.map(other)),
    });
  }
  return {
    width: now().width,
    height: now().height,
    scales: {x: scale('x'), y: scale('y')},
    axes,
    series: [{}, {scale: 'y', paths: () => null, points: {show: false}}],
    legend: {show: false},
    padding: [8, 14, 2, 0],
    cursor: {drag: {x: false, y: false, setScale: false}, points: {show: false}, focus: {prox: -1}},
    hooks: {draw: [/** @param {uPlot} u */ (u) => now().draw(u)]},
  };
}

/**
 * Value at a share of an axis, or at the end that is beyond it.
 * @param {Axis} axis
 * @param {number[]} ends
 * @param {number} share
 */
const valueAt = (axis, ends, share) => along(axis, ends).back(Math.min(Math.max(share, 0), 1));

/**
 * Step along an axis by a share of its length.
 * @param {Axis} axis
 * @param {number[]} ends
 * @param {number} value
 * @param {number} share
 */
const stepped = (axis, ends, value, share) => valueAt(axis, ends, along(axis, ends).to(value) + share);

/** @param {PanelProps} props */
export function ChartPanel(props) {
  const {
    panel,
    place,
    behind,
    width,
    height,
    hasXText,
    theme,
    drag,
    over,
    onPick,
    picks = 'sets the rig',
    onRead,
    ringed,
    say,
  } = props;
  const [host, handle, veil, plot] = [useRef(null), useRef(null), useRef(null), useRef(null)];
  const latest = useRef(null);
  const [tip, setTip] = useState(null);
  const [held, setHeld] = useState(null);
  const [at, grabbed, pressed] = [useRef(null), useRef(null), useRef(null)];
  const ranges = grabbed.current ?? props.ranges; // an axis that follows the rule stands still under the pointer
  const rule = drag ? panel.parts.find((part) => part.kind === 'rule' && part.along === 'x') : null;

  /** @param {uPlot} u */
  const mapOf = (u) => mapping(panel, ranges, u.bbox);
  latest.current = {
    ...props,
    ranges,
    /** @param {uPlot} u */
    draw: (u) => {
      const map = mapOf(u);
      drawParts(u.ctx, panel, {map, theme, scale: devicePixelRatio, behind, rule, held, ringed});
      const [left, top, length, high] = [map.box.left, map.box.top, map.box.width, map.box.height].map(
        (each) => each / devicePixelRatio,
      );
      if (veil.current)
        Object.assign(veil.current.style, {
          left: `${left}px`,
          top: `${top}px`,
          width: `${length}px`,
          height: `${high}px`,
        });
      if (!handle.current || !rule) return;
      Object.assign(handle.current.style, {
        left: `${left - THUMB / 2}px`,
        top: `${top}px`,
        width: `${length + THUMB}px`,
        height: `${high}px`,
      });
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
  useLayoutEffect(() => plot.current.redraw(false), [held, ringed?.x, ringed?.y]);
  useEffect(() => {
    if (!grabbed.current) setHeld(null);
    setTip((old) => (old?.isKept ? old : null));
  }, [panel]);

  /**
   * Place of a pointer in pixels of the canvas, and in the axes; null beyond them.
   * @param {PointerEvent} event
   */
  const placeOf = (event) => {
    const box = host.current.getBoundingClientRect();
    const map = mapOf(plot.current);
    const [left, top] = [event.clientX - box.left, event.clientY - box.top].map((each) => each * devicePixelRatio);
    const isIn =
      left >= map.box.left &&
      left <= map.box.left + map.box.width &&
      top >= map.box.top &&
      top <= map.box.top + map.box.height;
    return {map, left, top, isIn, x: map.x.back(left), y: map.y.back(top)};
  };
  /**
   * @param {Mapping} map
   * @param {number} left
   * @param {number} top
   * @param {string[]} texts
   * @param {boolean} [isKept]
   */
  const showTip = (map, left, top, texts, isKept = false) => {
    setTip({left: left / devicePixelRatio, top: top / devicePixelRatio, texts, isKept});
    plot.current.setCursor(
      {left: (left - map.box.left) / devicePixelRatio, top: (top - map.box.top) / devicePixelRatio},
      false,
    );
  };
  const hide = () => {
    setTip(null);
    onRead?.(null);
    plot.current?.setCursor({left: -10, top: -10}, false);
  };
  /** @param {PointerEvent} event */
  const hover = (event) => {
    const {map, left, top, isIn, x, y} = placeOf(event);
    if (!isIn) return hide();
    at.current = {x, y, number: at.current?.number ?? -1};
    const near = nearPoint(panel, map, left, top, devicePixelRatio);
    onRead?.(near ?? null);
    return showTip(map, left, top, near ? pointText(panel, near) : valuesAt(panel, x, y));
  };
  /** @param {PointerEvent} event */
  const pick = (event) => {
    const start = pressed.current;
    if (!onPick || (start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) > MOVED)) return;
    const {isIn, x, y} = placeOf(event);
    if (isIn) onPick({panel: place, x, y});
  };

  /**
   * Arrow keys read values, up and down where there are no points, else point after point.
   * @param {KeyboardEvent} event
   */
  const press = (event) => {
    const points = pointsOf(panel);
    /** @type {ReadPlace} */
    const now = at.current ?? {
      x: rule?.value ?? valueAt(panel.x, ranges.x, 0.5),
      y: valueAt(panel.y, ranges.y, 0.5),
      number: -1,
    };
    const size = (event.shiftKey ? 10 : 1) / STEPS;
    /** @param {Name} name @param {number} share @returns {[ReadPlace]} */
    const step = (name, share) => [{...now, [name]: stepped(panel[name], ranges[name], now[name], share)}];
    /** @param {number} by @returns {[ReadPlace, string[]]} */
    const toPoint = (by) => {
      const number = (now.number + by + points.length) % points.length;
      onRead?.(points[number]);
      return [{x: points[number].x, y: points[number].y, number}, pointText(panel, points[number])];
    };
    const isByPoint = points.length > 0 && !fieldOf(panel);
    /** @type {Record<string, () => [ReadPlace, string[]?]>} */
    const moves = {
      ArrowLeft: () => step('x', -size),
      ArrowRight: () => step('x', size),
      ArrowUp: () => (isByPoint ? toPoint(now.number < 0 ? 0 : -1) : step('y', size)),
      ArrowDown: () => (isByPoint ? toPoint(1) : step('y', -size)),
    };
    const pickNow = event.key === 'Enter' || event.key === ' ' ? onPick : undefined;
    if (event.key === 'Escape') hide();
    if (!pickNow && !moves[event.key]) return null;
    event.preventDefault();
    if (pickNow) return pickNow({panel: place, x: now.x, y: now.y});
    const [reached, texts = valuesAt(panel, reached.x, reached.y)] = moves[event.key]();
    at.current = reached;
    const map = mapOf(plot.current);
    showTip(map, map.x.to(reached.x), map.y.to(reached.y), texts, true);
    return say(texts.join('; '));
  };

  /** @param {FieldEvent} event */
  const dragged = (event) => valueAt(panel.x, ranges.x, Number(event.target.value) / RULE_STEPS);
  /** @param {FieldEvent} event */
  const move = (event) => {
    grabbed.current ??= props.ranges;
    setHeld(dragged(event));
    drag?.onMove(dragged(event));
  };
  /** @param {FieldEvent} event */
  const release = (event) => {
    grabbed.current = null;
    drag?.onRelease(dragged(event));
  };

  const value = rule && (held ?? rule.value);
  const byPoints = pointsOf(panel).length ? ', up and down the points' : '';
  const hint = `Arrow keys read values${byPoints}${onPick ? `, Enter ${picks}` : ''}.`;
  return html`<div class="chart-frame">
    <div
      ref=${host}
      class=${`chart-plot${onPick ? ' is-pickable' : ''}`}
      role="img"
      tabindex="0"
      data-test=${`plot:${place}`}
      aria-label=${`${panelName(panel)}. ${hint}`}
      onPointerMove=${hover}
      onPointerLeave=${hide}
      onKeyDown=${press}
      onBlur=${hide}
      onPointerDown=${(event) => {
        pressed.current = [event.clientX, event.clientY];
        hover(event);
      }}
      onClick=${pick}
    ></div>
    ${
      rule &&
      html`<input
        ref=${handle}
        type="range"
        class="chart-handle"
        min="0"
        max=${RULE_STEPS}
        value=${Math.round(RULE_STEPS * along(panel.x, ranges.x).to(value))}
        aria-valuetext=${withUnit(value, panel.x)}
        aria-label=${`${rule.label || 'Value'}, ${flat(panel.x.label)}`}
        data-test=${`drag:${place}`}
        onInput=${move}
        onChange=${release}
        onPointerDown=${hide}
      />`
    }
    ${over && html`<div ref=${veil} class="chart-over">${over(panel, ranges)}</div>`}
    ${
      tip &&
      html`<div
        class=${`chart-tip${tip.left > width / 2 ? ' is-left' : ''}${tip.top > height / 2 ? ' is-above' : ''}`}
        style=${{
          left: `${tip.left}px`,
          top: `${tip.top}px`,
          maxWidth: `${Math.max(150, Math.max(tip.left, width - tip.left) - 16)}px`,
        }}
        aria-hidden="true"
        data-test="tip"
      >
        ${tip.texts.map(
          /** @param {string} text @param {number} number */
          (text, number) => html`<div key=${number}>${text}</div>`,
        )}
      </div>`
    }
  </div>`;
}
