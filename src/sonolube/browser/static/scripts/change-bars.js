/** Changes of friction and wear as intervals on one scale, from no change to gone. */
import {html} from '../vendor/htm-preact-3.1.1.js';
import {classes} from './parts.js';

/**
 * @typedef {{median: number, interval_50: number[], interval_80: number[]}} Predicted
 * @typedef {{name: string, change?: Predicted|null, note?: string, text?: string}} Row
 */

const percent = (/** @type {number} */ share) => `${Math.round(100 * share)}`;

/** Change in percent of a reduction, with its sign. @param {number} reduction */
export const changeText = (reduction) => `${reduction > 0 ? '−' : '+'}${percent(Math.abs(reduction))} %`;

/** Interval of a reduction in words. @param {number[]} ends */
function rangeText([low, high]) {
  if (high <= 0) return `${percent(-high)} to ${percent(-low)} % more`;
  return low < -0.005 ? `${percent(-low)} % more to ${percent(high)} % less` : `${percent(low)} to ${percent(high)} %`;
}

/** Place of a share on the scale, in percent of its width. @param {number} share */
const place = (share) => 100 * Math.min(Math.max(share, 0), 1);

/**
 * Part of a bar between two shares.
 * @param {{ends: number[], kind: string}} props
 */
const Part = ({ends: [low, high], kind}) =>
  html`<span
    class=${classes('bar-part', {[kind]: true})}
    style=${{left: `${place(low)}%`, width: `${Math.max(place(high) - place(low), 0.6)}%`}}
  ></span>`;

/**
 * Interval of 80 % with that of 50 % and the median.
 * @param {{change: Predicted, label: string, faint?: boolean}} props
 */
export const Bar = ({change, label}) => html`<span class="bar" role="img" aria-label=${label}>
  <${Part} ends=${change.interval_80} kind="is-80" />
  <${Part} ends=${change.interval_50} kind="is-50" />
  <${Part} ends=${[change.median, change.median]} kind="is-median" />
</span>`;

/**
 * Rows of changes, each with its median; a row without an interval has a text.
 * @param {{rows: Row[], test: string}} props
 */
export const ChangeBars = ({rows, test}) => html`<section class="card bars" aria-label="Changes" data-test=${test}>
  <p class="bar-scale" aria-hidden="true"><span>no change</span><span>50 % less</span><span>gone</span></p>
  ${rows.map(
    ({name, change, note, text}) => html`<p key=${name} class=${classes('bar-row', {'has-no-bar': !change})}>
      <b class="bar-name">${name}</b>
      ${
        change
          ? html`<${Bar} change=${change} label=${`${name}: ${rangeText(change.interval_80)} with 8 chances in 10`} />
              <span class="bar-text"><b>${changeText(change.median)}</b> <span class="bar-note">${note}</span></span>`
          : html`<span class="bar-text">${text}</span>`
      }
    </p>`,
  )}
</section>`;
