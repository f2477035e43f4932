/** Parts of an answer as a page shows them: blocks of text, caveats, assumptions, refusals, differences. */
import {html, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {askAgain} from './api.js';
import {focusField} from './fields.js';
import {Button, Warning} from './parts.js';
/**
 * @typedef {{kind: 'rows'|'table'|'verbatim'|'text', rows?: string[][], heads?: string[], text?: string}} Block
 * @typedef {{leading_caveats?: string[], caveats?: string[], refusals?: Record<string, string>, assumptions?:
 *   Record<string, string>}} Stated what an answer says beside its numbers
 * @typedef {{name: string, caption?: string, chart: import('./chart-scale.js').ChartData, tables?:
 *   import('./chart.js').ChartTable[]}} Drawing
 * @typedef {Stated & {blocks: Block[], charts: (Omit<Drawing, 'chart'> & {chart: Drawing['chart']|null})[], answer:
 *   any, files?: string[]}} Content of the answer of a task
 */

const MOST = 100; // rows shown before all are asked for

/**
 * Table of texts; the first of a row is its head, where `hasRowHeads` is not false.
 * @param {{heads?: string[], rows: string[][], caption?: string, label?: string, test?: string, kind?: string,
 *   hasRowHeads?: boolean}} props
 */
export function TextTable({heads, rows, caption, label, test, kind = 'table-frame', hasRowHeads = true}) {
  const [isAll, setAll] = useState(false);
  const shown = isAll ? rows : rows.slice(0, MOST);
  return html`<div
    class=${kind}
    tabindex="0"
    role="group"
    aria-label=${label ?? caption ?? heads?.filter(Boolean).join(', ') ?? 'Table'}
  >
    <table class="table" data-test=${test}>
      ${caption && html`<caption>${caption}</caption>`}
      ${
        heads?.some(Boolean) &&
        html`<thead>
          <tr>
            ${heads.map(
              (head, place) => html`<th key=${place} scope="col">
                ${head || html`<span class="hidden">Quantity</span>`}
              </th>`,
            )}
          </tr>
        </thead>`
      }
      <tbody>
        ${shown.map(
          (row, at) =>
            html`<tr key=${at}>
              ${row.map((cell, place) =>
                place === 0 && hasRowHeads
                  ? html`<th key=${place} scope="row">${cell}</th>`
                  : html`<td key=${place}>${cell}</td>`,
              )}
            </tr>`,
        )}
      </tbody>
    </table>
    ${
      shown.length < rows.length &&
      html`<${Button} kind="button is-quiet" onClick=${() => setAll(true)}>
        Show ${rows.length - shown.length} further rows
      <//>`
    }
  </div>`;
}

/**
 * Kinds of a block of an answer.
 * @type {Record<string, (block: any) => import('../vendor/htm-preact-3.1.1.js').VNode>}
 */
const BLOCKS = {
  rows: ({rows}) => html`<${TextTable} rows=${rows} />`,
  table: ({heads, rows}) => html`<${TextTable} heads=${heads} rows=${rows} />`,
  verbatim: ({text}) => html`<pre class="verbatim" tabindex="0">${text}</pre>`,
  text: ({text}) => html`<p>${text}</p>`,
};

/** Figures of an answer that a page can draw. @param {Content} content @returns {Drawing[]} */
export const drawings = ({charts}) => charts.flatMap(({chart, ...rest}) => (chart ? [{...rest, chart}] : []));

/** All blocks, or some of them. @param {{blocks: Block[]}} properties */
export const Blocks = ({blocks}) =>
  blocks.map((block, place) => html`<${BLOCKS[block.kind]} key=${place} ...${block} />`);

/**
 * Lines of now that were not there when the page last rested; `of` names what is answered at rest.
 * @param {string[]} lines
 * @param {boolean} isMoving
 * @param {string} of
 */
function useChanged(lines, isMoving, of) {
  const rest = useRef({of: /** @type {string|null} */ (null), now: lines, before: lines});
  if (!isMoving && rest.current.of !== of) {
    rest.current = {of, now: lines, before: rest.current.of === null ? lines : rest.current.now};
  }
  return new Set(lines.filter((line) => !rest.current.before.includes(line)));
}

/**
 * Caveats and assumptions of an answer; what changed since the last rest is marked.
 * @param {{answer: Stated, isMoving: boolean, of: string, hasFields?: boolean}} props `of` names the request that was
 *   answered; with fields on the page, what is assumed leads to them
 */
export function Caveats({answer, isMoving, of, hasFields = true}) {
  const {leading_caveats: leading = [], caveats = [], refusals = {}, assumptions = {}} = answer;
  /** @type {[string, string, {line?: string, shown: any}[]][]} */
  const every = [
    ['Caveats', '', [...leading, ...caveats].map((line) => ({line, shown: line}))],
    ['Refused inputs', '', Object.entries(refusals).map(([name, reason]) => ({shown: `${name}: ${reason}`}))],
    [
      'Assumed',
      ' is-assumed',
      Object.entries(assumptions).map(([key, reason]) => ({
        line: `${key}: ${reason}`,
        shown: html`
          ${
            hasFields
              ? html`<${Button} kind="link" onClick=${() => focusField(key)}>${key}<//>`
              : html`<code>${key}</code>`
          } ${reason}
        `,
      })),
    ],
  ];
  const lists = every.filter(([, , rows]) => rows.length);
  const lines = lists.flatMap(([, , rows]) => rows.flatMap(({line}) => line ?? []));
  const changed = useChanged(lines, isMoving, of);
  if (!lists.length) return html`<p class="hint">No caveats, and nothing assumed.</p>`;
  return html`<div class="caveats" data-test="caveats">
    ${lists.map(
      ([title, kind, rows]) => html`
        <h3>${title}</h3>
        <ul class=${`caveat-list${kind}`}>
          ${rows.map(
            ({line = '', shown}, at) => html`<li key=${line || at} class=${changed.has(line) ? 'is-new' : ''}>
              ${changed.has(line) && html`<span class="tag is-new">changed</span> `}
              ${shown}
            </li>`,
          )}
        </ul>
      `,
    )}
  </div>`;
}

/**
 * What a failed request shows, beside the last answer; `shown` are keys whose faults stand under their fields.
 * @param {{failure: import('./api.js').Failure, shown?: string[]}} properties
 */
export function Failure({failure, shown = []}) {
  if (!failure || failure.kind === 'offline' || failure.kind === 'link') return null;
  const faults = failure.faults.filter((fault) => !shown.includes(fault.key));
  const texts = [...new Set(faults.map((fault) => fault.text || failure.text))];
  const isBelow = !texts.length; // the fields
  return html`<${Warning} data-test="refused">
    <strong>${isBelow ? 'Not computed:' : failure.kind === 'refused' ? 'Refused.' : 'Not computed.'}</strong>
    ${isBelow && ' an entry is refused; the reason stands under its field.'}
    ${texts.map((text) => html`<p key=${text}>${text}</p>`)}
    ${!isBelow && failure.kind === 'busy' && html`<${Button} onClick=${askAgain}>Ask again<//>`}
  <//>`;
}

/**
 * Note that some entries are refused, while the numbers are those of the last accepted ones.
 * @param {{refused: import('./api.js').Fault[]}} properties
 */
export function RefusedNote({refused}) {
  if (!refused.length) return null;
  return html`<p class="notice is-warning" role="status" data-test="left-out">
    The numbers leave out what is refused:${' '}
    ${refused.map(
      ({key}, place) =>
        html`${place > 0 && ', '}<${Button} kind="link" key=${key} onClick=${() => focusField(key)}>${key}<//>`,
    )}. They are of the value that was accepted last.
  </p>`;
}
