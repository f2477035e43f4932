/** Parts of an answer as a page shows them: blocks of text, caveats, assumptions, refusals, differences. */
import {html, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {askAgain} from './api.js';
import {focusField} from './fields.js';

const MOST = 100; // rows shown before all are asked for

/**
 * Table of texts; the first of a row is its head, where `hasRowHeads` is not false.
 * @param {{heads?: string[], rows: string[][], caption?: string, label?: string, test?: string, kind?: string, hasRowHeads?: boolean}} props
 */
export function TextTable({heads, rows, caption, label, test, kind = 'table-frame', hasRowHeads = true}) {
  const [isAll, setAll] = useState(false);
  const shown = isAll ? rows : rows.slice(0, MOST);
  return html`<div class=${kind} tabindex="0" role="group" aria-label=${label ?? caption ?? heads?.filter(Boolean).join(', ') ?? 'Table'}>
    <table class="table" data-test=${test}>
      ${caption && html`<caption>${caption}</caption>`}
      ${heads?.some(Boolean) && html`<thead><tr>${heads.map((head, place) => html`<th key=${place} scope="col">
        ${head || html`<span class="hidden">Quantity</span>`}</th>`)}</tr></thead>`}
      <tbody>${shown.map((row, at) => html`<tr key=${at}>${row.map((cell, place) => (place === 0 && hasRowHeads
    ? html`<th key=${place} scope="row">${cell}</th>` : html`<td key=${place}>${cell}</td>`))}</tr>`)}</tbody>
    </table>
    ${shown.length < rows.length && html`<button type="button" class="button is-quiet" onClick=${() => setAll(true)}>
      Show ${rows.length - shown.length} further rows</button>`}</div>`;
}

/** Block of an answer: text, rows, table or verbatim. */
export function Block({block}) {
  if (block.kind === 'rows') return html`<${TextTable} rows=${block.rows} caption=${undefined} heads=${[]} />`;
  if (block.kind === 'table') return html`<${TextTable} heads=${block.heads} rows=${block.rows} />`;
  if (block.kind === 'verbatim') return html`<pre class="verbatim" tabindex="0">${block.text}</pre>`;
  return html`<p>${block.text}</p>`;
}

/** All blocks, or some of them. */
export const Blocks = ({blocks}) => html`${blocks.map((block, place) => html`<${Block} key=${place} block=${block} />`)}`;

/**
 * Lines of now, and which of them were not there when the page last rested.
 * @param {string[]} lines
 * @param {boolean} isMoving
 * @param {string} of what is answered at rest; the comparison is with the rest before it
 */
function useChanged(lines, isMoving, of) {
  const rest = useRef({of: null, now: lines, before: lines});
  if (!isMoving && rest.current.of !== of) {
    rest.current = {of, now: lines, before: rest.current.of === null ? lines : rest.current.now};
  }
  return new Set(lines.filter((line) => !rest.current.before.includes(line)));
}

/**
 * Caveats and assumptions of an answer; what changed since the last rest is marked.
 * @param {{answer: Object, isMoving: boolean, of: string, hasFields?: boolean}} props `of` names the request that was
 *   answered; with fields on the page, what is assumed leads to them
 */
export function Caveats({answer, isMoving, of, hasFields = true}) {
  const caveats = [...(answer.leading_caveats ?? []), ...(answer.caveats ?? [])];
  const assumed = Object.entries(answer.assumptions ?? {});
  const refused = Object.entries(answer.refusals ?? {});
  const changed = useChanged([...caveats, ...assumed.map(([key, reason]) => `${key}: ${reason}`)], isMoving, of);
  const mark = (line) => (changed.has(line) ? 'is-new' : '');
  const flag = (line) => changed.has(line) && html`<span class="tag is-new">changed</span> `;
  if (!caveats.length && !assumed.length && !refused.length) {
    return html`<p class="hint">No caveats, and nothing assumed.</p>`;
  }
  return html`<div class="caveats" data-test="caveats">
    ${caveats.length > 0 && html`<h3>Caveats</h3><ul class="caveat-list">${caveats.map((line) => html`<li key=${line}
      class=${mark(line)}>${flag(line)}${line}</li>`)}</ul>`}
    ${refused.length > 0 && html`<h3>Refused inputs</h3><ul class="caveat-list">${refused.map(([name, reason]) => html`
      <li key=${name}>${name}: ${reason}</li>`)}</ul>`}
    ${assumed.length > 0 && html`<h3>Assumed</h3><ul class="caveat-list is-assumed">${assumed.map(([key, reason]) => html`
      <li key=${key} class=${mark(`${key}: ${reason}`)}>${flag(`${key}: ${reason}`)}${hasFields
    ? html`<button type="button" class="link" onClick=${() => focusField(key)}>${key}</button>` : html`<code>${key}</code>`}
      ${' '}${reason}</li>`)}</ul>`}
  </div>`;
}

/**
 * What a failed request shows, beside the last answer.
 * @param {{failure: Object|null, shown?: string[]}} props `shown` are keys whose faults stand under their fields
 */
export function Failure({failure, shown = []}) {
  if (!failure || failure.kind === 'offline' || failure.kind === 'link') return null;
  const faults = failure.faults.filter((fault) => !shown.includes(fault.key));
  const texts = [...new Set(faults.map((fault) => fault.text || failure.text))];
  if (!texts.length) {
    return html`<div class="notice is-warning" role="alert" data-test="refused">
      <strong>Not computed:</strong> an entry is refused; the reason stands under its field.</div>`;
  }
  return html`<div class="notice is-warning" role="alert" data-test="refused">
    <strong>${failure.kind === 'refused' ? 'Refused.' : 'Not computed.'}</strong>
    ${texts.map((text) => html`<p key=${text}>${text}</p>`)}
    ${failure.kind === 'busy' && html`<button type="button" class="button" onClick=${askAgain}>Ask again</button>`}</div>`;
}

/**
 * Note that some entries are refused, while the numbers are those of the last accepted ones.
 * @param {{refused: Object[]}} props
 */
export function RefusedNote({refused}) {
  if (!refused.length) return null;
  return html`<p class="notice is-warning" role="status" data-test="left-out">The numbers leave out what is refused:${' '}
    ${refused.map((fault, place) => html`${place > 0 && ', '}<button type="button" class="link" key=${fault.key}
    onClick=${() => focusField(fault.key)}>${fault.key}</button>`)}. They are of the value that was accepted last.</p>`;
}
