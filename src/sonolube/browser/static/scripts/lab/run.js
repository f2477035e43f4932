/**
 * The run at work, or the latest: its state, step and time, what it asks, its live channels, and how near its limits
 * are.
 */
import {html, useEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {useConnection} from '../api.js';
import {Chart} from '../chart.js';
import {short} from '../chart-scale.js';
import {duration} from '../job.js';
import {Button, capital, Card, classes, Warning} from '../parts.js';
import {isAtWork, look} from './lab.js';
/**
 * @import {Channel, Devices, Run} from './lab.js'
 * @typedef {[number, number, number, number]} Slice time, lowest, highest, mean
 * @typedef {{label: string, unit: string, value: number|null, limit: number|null, share: number|null}} LimitNow
 * @typedef {Partial<Run> & {channels?: Record<string, Slice[]>, limits?: LimitNow[]}} Frame of a run at work
 */

const NEAR = 0.8; // of the way to a limit, from which it is marked
const [SPAN, AGAIN] = [20, 1000]; // s shown, ms after a stream has ended
const [COLOUR, MARGIN] = ['#0072b2', 0.15]; // the margin of the range, above and below
/** @type {Map<string, Slice[]>} */
const NONE = new Map();
/** Sign of each state beside its word. @type {Record<string, string>} */
const SIGNS = {
  preparing: '…',
  running: '▶',
  paused: '❚❚',
  stopping: '◼',
  safe: '✓',
  failed: '✕',
  lost: '✕',
  completed: '✓',
  stopped: '◼',
  refused: '✕',
};
/** @type {Record<string, string>} */
const OFF = {
  failed: 'Cut the power: motor or drive may be on.',
  lost: 'Cut the power: the program of this run is gone, and nobody knows whether motor and drive are off.',
};

/**
 * Enter the slices of a frame into those of the last seconds.
 * @param {Map<string, Slice[]>} kept
 * @param {Object<string, Slice[]>} channels
 */
function enter(kept, channels) {
  for (const [name, slices] of Object.entries(channels)) {
    const known = kept.get(name) ?? [];
    const latest = known.at(-1)?.[0] ?? -Infinity;
    // a stream that begins again repeats some
    const all = [...known, ...slices.filter(([time]) => time > latest)];
    const end = all.at(-1)?.[0] ?? 0;
    kept.set(
      name,
      all.filter(([time]) => time >= end - SPAN),
    );
  }
}

/** Read frames until the stream ends. @param {(frame: Frame) => void} take @param {AbortSignal} signal */
async function read(take, signal) {
  const response = await fetch('api/lab/live', {signal, headers: {'x-status': 'in-header'}});
  if (!response.body) return;
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    const lines = (rest + part.value).split('\n');
    rest = lines.pop() ?? '';
    for (const line of lines) take(JSON.parse(line));
  }
}

/**
 * Last frame of a run while it is at work, and the slices of each channel.
 * @param {string} run
 * @param {boolean} isFollowed
 * @returns {{frame: Frame|null, kept: Map<string, Slice[]>}}
 */
export function useLive(run, isFollowed) {
  const [{of, ...shown}, show] = useState({of: '', frame: /** @type {Frame|null} */ (null), kept: NONE});
  useEffect(() => {
    if (!isFollowed) return undefined;
    const [slices, end] = [new Map(), new AbortController()];
    /** @param {Frame} next */
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
  return of === run ? shown : {frame: null, kept: NONE};
}

/**
 * Ends of an axis that hold all values; those of before while they fit, so that the axis stands still.
 * @param {number[]} lows
 * @param {number[]} highs
 * @param {number[]|undefined} before
 * @returns {number[]}
 */
function endsOf(lows, highs, before) {
  if (!lows.length) return before ?? [0, 1];
  const [low, high] = [Math.min(...lows), Math.max(...highs)];
  const room = (high - low || Math.abs(high) || 1) * MARGIN;
  const isKept = before && before[0] <= low && before[1] >= high && before[1] - before[0] < 2.5 * (high - low + room);
  return isKept ? before : [low - room, high + room];
}

/**
 * Channels that have slices, a panel each; with reduced motion they fill page by page rather than move.
 * @param {{channels: Channel[], kept: Map<string, Slice[]>, time: number}}
 *   properties
 */
export function Strips({channels, kept, time}) {
  const ends = useRef(new Map());
  const start = matchMedia('(prefers-reduced-motion: reduce)').matches
    ? Math.floor(time / SPAN) * SPAN
    : Math.max(0, time - SPAN);
  const panels = channels
    .filter(({name}) => kept.has(name))
    .map(({name, label, unit}) => {
      const slices = (kept.get(name) ?? []).filter(([at]) => at >= start);
      const [x, low, high, mean] = [0, 1, 2, 3].map((place) => slices.map((slice) => slice[place]));
      ends.current.set(name, endsOf(low, high, ends.current.get(name)));
      const [lowest, highest] = ends.current.get(name);
      return {
        title: `${capital(label)} ${short(mean.at(-1) ?? null, 3)} ${unit}`,
        x: {label: 'Time', text: 'Time [s]', unit: 's', lowest: start, highest: start + SPAN},
        y: {label, text: `[${unit}]`, unit, lowest, highest},
        parts: [
          {kind: 'band', x, low, high, colour: COLOUR, opacity: 0.3},
          {kind: 'line', x, y: mean, colour: COLOUR},
        ],
      };
    });
  const chart = {panels, columns: 2, size: [8, Math.ceil(panels.length / 2)], legend: 'none'};
  return panels.length > 0 && html`<${Chart} name="live" chart=${chart} />`;
}

/**
 * What the operator is asked; beside the page, so that the stop button stays within reach.
 * @param {{prompt: NonNullable<Run['prompt']>, confirm: ((isDone: boolean) => void)|false}} props
 */
function Prompt({prompt, confirm}) {
  const dialog = useRef(null);
  useEffect(() => dialog.current.focus(), [prompt.number]);
  return html`<div
    class="prompt"
    role="dialog"
    aria-labelledby="prompt-title"
    aria-describedby="prompt-text"
    tabindex="-1"
    ref=${dialog}
    data-test="prompt"
  >
    <h2 id="prompt-title">To do: ${prompt.task}</h2>
    <p id="prompt-text">${prompt.text}</p>
    <p class="hint">Motor and drive are off, and the clock of the protocol stands. Is it done?</p>
    ${
      confirm
        ? html`<p class="row">
          <${Button} kind="button is-main" onClick=${() => confirm(true)} data-test="confirm">It is done: go on<//>
          <${Button} onClick=${() => confirm(false)} data-test="not-done">It cannot be done: end the run<//>
        </p>`
        : html`<p>The tab that holds the laboratory confirms it.</p>`
    }
  </div>`;
}

/** @param {LimitNow} props */
function Limit({label, unit, value, limit, share}) {
  const isNear = (share ?? 0) >= NEAR;
  return html`<li class=${classes('limit', {'is-near': isNear})}>
    <span>${capital(label)}</span>
    <meter min="0" max="1" high=${NEAR} optimum="0" value=${Math.min(share ?? 0, 1)} aria-label=${label}></meter>
    <span>
      ${`${short(value, 3)} of ${short(limit, 3)} ${unit}, `}
      <strong>${share == null ? '–' : Math.round(100 * share)} %${isNear ? ' ⚠ near the limit' : ''}</strong>
    </span>
  </li>`;
}

/** @param {{run: Run, devices: Devices, isHolder: boolean, ask: (what: string, more?: object) => any}} properties */
export function RunCard({run, devices, isHolder, ask}) {
  const {frame, kept} = useLive(run.id, isAtWork(run));
  const isGone = useConnection().connection !== 'ok';
  /** @type {Run} */
  const now = {...run, ...(isAtWork(run) && frame)};
  const word = isAtWork(now) ? now.state : now.outcome || now.state;
  /** @param {boolean} isDone */
  const confirm = (isDone) => ask('confirm', {number: now.prompt?.number, is_done: isDone});
  const {trips = []} = now;
  const limits = (isAtWork(now) && frame?.limits) || [];
  return html`<${Card} id="run-title" title=${now.title || now.protocol} data-test="run">
    <p class="row">
      <span class=${`run-state is-${word}`} role="status" data-test="run-state">
        <span aria-hidden="true">${SIGNS[word]}</span> ${word}
        ${isGone && ' when last seen'}
      </span>
      <span data-test="run-step">
        ${now.step && `step ${now.step} of ${now.steps}`}
        ${now.doing && `: ${now.doing.replace(/^step [\d.]+, /, '')}`}
      </span>
    </p>
    ${
      OFF[now.state] && html`<${Warning} data-test="cut-power"><strong class="cut-power">${OFF[now.state]}</strong><//>`
    }
    <p class="row">
      <progress class="grow" max=${now.total || 1} value=${now.time ?? 0} aria-label="Time of the protocol"></progress>
      <span data-test="run-time">${duration(now.time ?? 0)} of ${duration(now.total ?? 0)}</span>
      ${
        isHolder &&
        now.state === 'running' &&
        html`<${Button} onClick=${() => ask('pause')} data-test="pause">Pause<//>`
      }
      ${
        isHolder &&
        now.is_paused &&
        !now.prompt &&
        html`<${Button} kind="button is-main" onClick=${() => ask('resume')} data-test="resume">Resume<//>`
      }
    </p>
    ${now.outcome && now.outputs && html`<p data-test="run-outputs">Motor and drive: ${now.outputs}</p>`}
    ${now.outcome && now.reason && html`<p data-test="run-reason">Ended: ${now.reason}</p>`}
    ${trips.length > 0 && html`<${Warning}>${trips.map((trip) => html`<p key=${trip}>${trip}</p>`)}<//>`}
    ${now.prompt && isAtWork(now) && html`<${Prompt} prompt=${now.prompt} confirm=${isHolder && confirm} />`}
    ${
      limits.length > 0 &&
      html`
        <h3>How near the limits are</h3>
        <ul class="limits" data-test="limits">
          ${limits.map((each) => html`<${Limit} key=${each.label} ...${each} />`)}
        </ul>
      `
    }
    <${Strips} channels=${devices.channels} kept=${kept} time=${now.time ?? 0} />
    <p class="hint">
      ${now.is_virtual ? `Virtual rig ${now.rig}, seed ${now.seed}` : devices.title}
      ${now.folder && `; recorded in ${now.folder}`}
    </p>
  <//>`;
}
