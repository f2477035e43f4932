/** Live channels: frames of the run at work as they come, and the last seconds of each channel as a strip on a canvas. */
import {html, useEffect, useLayoutEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {roundTicks, short, themeOf} from '../chart-scale.js';
import {capital, useEvents} from '../parts.js';
import {look} from './lab.js';
/** @typedef {[number, number, number, number]} Slice time, lowest, highest, mean */

const SPAN = 20; // s on a strip
const AGAIN = 1000; // ms after a stream has ended
const [LEFT, BOTTOM, TICK] = [48, 16, 24]; // px for numbers, times, and of a number's room
const COLOUR = '#0072b2';
const NONE = new Map();
const MARGIN = 0.15; // of the range, above and below

/** Enter the slices of a frame into those that are kept, which begin before the strip does. @param {Map<string, Slice[]>} kept @param {Object<string, Slice[]>} channels */
function enter(kept, channels) {
  for (const [name, slices] of Object.entries(channels)) {
    const known = kept.get(name) ?? [];
    for (const slice of slices) if (!known.length || slice[0] > known.at(-1)[0]) known.push(slice);
    const old = known.length ? known.findIndex(([time]) => time >= known.at(-1)[0] - SPAN) : 0;
    kept.set(name, old > known.length / 2 ? known.slice(old) : known); // seldom
  }
}

/** Read frames until the stream ends. @param {(frame: Object) => void} take @param {AbortSignal} signal */
async function read(take, signal) {
  const response = await fetch('api/lab/live', {signal, headers: {'x-status': 'in-header'}});
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    const lines = (rest + part.value).split('\n');
    rest = lines.pop();
    for (const line of lines) take(JSON.parse(line));
  }
}

/** Last frame of a run while it is at work, and the slices of each channel. @param {string} run @param {boolean} isFollowed @returns {{frame: Object|null, kept: Map<string, Slice[]>}} */
export function useLive(run, isFollowed) {
  const [{of, frame, kept}, show] = useState({});
  useEffect(() => {
    if (!isFollowed) return undefined;
    const [slices, end] = [new Map(), new AbortController()];
    const take = (next) => {
      enter(slices, next.channels ?? {});
      show({of: run, frame: next, kept: slices});
    };
    const follow = async () => {
      await read(take, end.signal).catch(() => null);
      if (end.signal.aborted) return;
      look();
      setTimeout(() => end.signal.aborted || follow(), AGAIN);
    };
    follow();
    return () => end.abort();
  }, [run, isFollowed]);
  return of === run ? {frame, kept} : {frame: null, kept: NONE};
}

/** Ends of an axis that hold all slices; those of before while they fit, so that the axis stands still. */
function endsOf(slices, before) {
  const low = slices.reduce((least, slice) => Math.min(least, slice[1]), Infinity);
  const high = slices.reduce((most, slice) => Math.max(most, slice[2]), -Infinity);
  if (!(low <= high)) return before ?? [0, 1];
  const room = (high - low || Math.abs(high) || 1) * MARGIN;
  return before?.[0] <= low && before[1] >= high && before[1] - before[0] < 4 * (high - low + room) ? before : [low - room, high + room];
}

/** Draw the slices of one channel from a time on. */
function draw(canvas, slices, start, [low, high], theme) {
  const [width, height, ratio] = [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
  Object.assign(canvas, {width: width * ratio, height: height * ratio}); // which clears it
  const paint = canvas.getContext('2d');
  paint.scale(ratio, ratio);
  const x = (time) => LEFT + ((time - start) / SPAN) * (width - LEFT);
  const y = (value) => 4 + ((high - value) / (high - low)) * (height - BOTTOM - 4);
  Object.assign(paint, {font: '11px system-ui, sans-serif', fillStyle: theme.muted, strokeStyle: theme.grid, textBaseline: 'middle', textAlign: 'right'});
  const rule = (x1, y1, x2, y2) => { paint.moveTo(x1, y1); paint.lineTo(x2, y2); };
  for (const tick of roundTicks(low, high, Math.max(2, (height - BOTTOM) / TICK))) {
    rule(LEFT, y(tick), width, y(tick));
    paint.fillText(short(tick), LEFT - 5, y(tick));
  }
  for (const tick of roundTicks(start, start + SPAN, 5)) {
    rule(x(tick), 4, x(tick), height - BOTTOM);
    if (x(tick) > LEFT + 20) paint.fillText(`${tick} s`, x(tick), height - BOTTOM / 2 + 1);
  }
  paint.stroke();
  const path = (some, of) => some.forEach((slice) => paint.lineTo(x(slice[0]), y(slice[of])));
  paint.beginPath();
  path(slices, 2);
  path(slices.toReversed(), 1);
  Object.assign(paint, {fillStyle: theme.stroke(COLOUR), strokeStyle: theme.stroke(COLOUR), lineWidth: 1.5, lineJoin: 'round', globalAlpha: 0.3});
  paint.fill();
  paint.globalAlpha = 1;
  paint.beginPath();
  path(slices, 3);
  paint.stroke();
}

/** Strips of the channels that have slices; with reduced motion they fill page by page rather than move. @param {{channels: {name: string, label: string, unit: string}[], kept: Map<string, Slice[]>, time: number}} properties */
export function Strips({channels, kept, time}) {
  const [host, ends] = [useRef(null), useRef(new Map())];
  const [turn, drawAgain] = useState({});
  useEvents(['themechange', 'resize'], () => drawAgain({}));
  useLayoutEffect(() => {
    const theme = themeOf(host.current);
    const start = matchMedia('(prefers-reduced-motion: reduce)').matches ? Math.floor(time / SPAN) * SPAN : Math.max(0, time - SPAN);
    for (const canvas of host.current.querySelectorAll('canvas')) {
      const {name} = canvas.dataset;
      const slices = kept.get(name).filter((slice) => slice[0] >= start);
      ends.current.set(name, endsOf(slices, ends.current.get(name)));
      draw(canvas, slices, start, ends.current.get(name), theme);
    }
  }, [kept, time, turn]);
  return html`<div class="strips" ref=${host} data-test="strips">${channels.filter(({name}) => kept.has(name)).map(({name, label, unit}) => {
    const [, lowest, highest, mean] = kept.get(name).at(-1) ?? [];
    return html`<figure key=${name}><figcaption>${capital(label)} <strong data-test=${`now:${name}`}>${short(mean, 3)} ${unit}</strong>${' '}
      <span class="hint">${short(lowest, 3)} to ${short(highest, 3)}</span></figcaption>
      <canvas data-name=${name} role="img" aria-label=${`${label}: the last ${SPAN} s; its latest values stand above`}></canvas></figure>`;
  })}</div>`;
}
