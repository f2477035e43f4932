/** Left column: which rig, its drawing, and its entries as fields; and the frame of a page that has it beside its answer. */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {useReply} from './api.js';
import {Field, spreadKey} from './fields.js';
import {Schematic} from './schematic.js';
import {addressOf, change, pack, useApp} from './state.js';

/** Last view that was read and its rig, so that a page that opens shows it at once. */
let last = {view: null, rig: {}};

/**
 * The rig of the state as the server shows it: title, fields, drawing, assumptions, names of rigs; null where refused.
 * @returns {{view: any, failure: Object|null, refused: Object[], isWaiting: boolean}}
 */
export function useRig() {
  const {state: {rig}, isMoving} = useApp();
  const asked = useRef(rig);
  if (!isMoving || rig.name !== asked.current.name) asked.current = rig; // values that move are not asked about
  const {content, failure, refused, isWaiting, of} = useReply('rig', rig.name ? 'api/rig' : null, {rig: asked.current});
  if (content) last = {view: content, rig: of.rig};
  const isOther = last.rig.name !== rig.name || last.rig.text !== rig.text;
  return {view: failure && isOther ? null : last.view, failure, refused, isWaiting};
}

/** Text of an entry: as it was typed, else as the file has it. */
export const textOf = (rig, field) => rig.changes[field.key] ?? field.text;

const tableOf = (field) => field.key.slice(0, field.key.lastIndexOf('.'));

/** Chooser of a rig: the examples, the one that was opened, an own file. */
function RigChoice({view}) {
  const {state} = useApp();
  const [note, setNote] = useState('');
  const chooser = useRef(null);
  const names = [...new Set([...(view?.rigs ?? last.view?.rigs ?? []), state.rig.name])].filter(Boolean);
  const own = state.rig.text !== undefined;
  const choose = (event) => {
    setNote('');
    change({rig: {name: event.target.value, changes: {}}, view: {pin: null, disc: null, runs: null, lost: null}});
  };
  const open = async ([file]) => setNote(await openRigText(file.name.replace(/\.toml$/i, ''), await file.text()));
  return html`<div class="rig-choice">
    <label for="rig-name">Rig</label>
    <div class="row">
      <select id="rig-name" value=${own ? '' : state.rig.name} onChange=${choose} data-test="rig" class="grow">
        ${own && html`<option value="" selected>${state.rig.name} (own file)</option>`}
        ${names.filter((name) => !own || name !== state.rig.name).map((name) => html`<option key=${name} value=${name}
          selected=${!own && name === state.rig.name}>${name}</option>`)}
      </select>
      <button type="button" class="button" onClick=${() => chooser.current.click()} data-test="open-rig">Open…</button>
      <a class="button" href=${addressOf('new')}>New…</a>
      <input type="file" accept=".toml" class="hidden" tabindex="-1" aria-label="Rig file" ref=${chooser}
        onChange=${(event) => event.target.files.length && open(event.target.files)} data-test="rig-file" />
    </div>
    ${view && html`<p class="hint" data-test="rig-title">${view.title}</p>`}
    ${note && html`<p class="hint" role="status">${note}</p>`}
    ${state.view.lost && html`<p class="refusal" role="alert" data-test="lost">The file of ${state.view.lost} is not in this
      link and no longer in this browser: open it again.</p>`}
  </div>`;
}

/** Make the text of a rig file the rig of the state, and go to a page; returns a note where a link cannot hold it. */
export async function openRigText(name, text, page = undefined) {
  const {fits} = await pack(text);
  change({...(page && {page}), rig: {name, text, changes: {}}, view: {lost: null}});
  return fits ? '' : 'This file is too long for a link: it stays in this tab only. Take it away as TOML to keep it.';
}

/**
 * @param {{extra?: any}} props `extra` stands below the fields of the operating point
 */
export function RigPanel({extra}) {
  const {state, setEntry, settle} = useApp();
  const {view, failure, refused} = useRig();
  const {rig} = state;
  const isAnswered = failure && ['refused', 'busy'].includes(failure.kind); // else the head says it
  const faults = new Map([...(isAnswered ? failure.faults : []), ...refused].map((fault) => [fault.key, fault.text]));
  const onText = (key, text, isMoving) => setEntry(key, text, {replace: isMoving});
  const fields = view?.fields ?? [];
  const first = fields.filter((field) => field.is_first);
  const others = fields.filter((field) => !field.is_first);
  const placed = new Set(fields.flatMap((field) => [field.key, spreadKey(field.key)]));
  const homeless = [...faults].filter(([key]) => !placed.has(key));
  const isAll = others.some((field) => faults.has(field.key));
  const list = (some) => some.map((field) => html`<${Field} key=${`${rig.name} ${field.key}`} field=${field}
    text=${textOf(rig, field)} spread=${rig.changes[spreadKey(field.key)]} isChanged=${field.key in rig.changes}
    refusal=${faults.get(field.key)} spreadRefusal=${faults.get(spreadKey(field.key))} onText=${onText}
    onSettle=${settle} />`);
  const count = Object.keys(rig.changes).length;
  return html`<aside class="rig" aria-label="Rig" data-test="rig-panel">
    <${RigChoice} view=${view} />
    ${!view && !failure && html`<p class="loading" role="status">Reading the rig…</p>`}
    ${view && html`<${Schematic} drawing=${view.drawing} fields=${fields} textOf=${(field) => textOf(rig, field)} />`}
    ${homeless.map(([key, text]) => html`<p key=${key} class="refusal" role="alert" data-test="rig-refusal">${text}</p>`)}
    <div class="fields">${list(first)}</div>
    ${count > 0 && html`<button type="button" class="button is-quiet" data-test="reset-all"
      onClick=${() => change({rig: {...rig, changes: {}}})}>Take back ${count === 1 ? 'the change' : `all ${count} changes`}</button>`}
    ${extra}
    ${others.length > 0 && html`<${AllEntries} isOpen=${isAll}>
      ${[...new Set(others.map(tableOf))].map((table) => html`<fieldset key=${table} class="fields"><legend>${table}</legend>
        ${list(others.filter((field) => tableOf(field) === table))}</fieldset>`)}<//>`}
    ${view?.source && html`<p class="hint source">Source: ${view.source}</p>`}
  </aside>`;
}

/** Entries beyond the operating point; opened where one of them is refused. */
function AllEntries({isOpen, children}) {
  const details = useRef(null);
  useEffect(() => {
    if (isOpen) details.current.open = true;
  }, [isOpen]);
  return html`<details ref=${details} class="all-entries" data-test="all-entries"><summary>All entries</summary>
    ${children}</details>`;
}

/**
 * Frame of a page with the rig: the lead above its answer (sticky on narrow screens), the rig, the answer.
 * @param {{lead?: any, extra?: any, children?: any}} props
 */
export function Workspace({lead, extra, children}) {
  return html`<div class="workspace">
    <div class="lead" id="answer" tabindex="-1">${lead}</div>
    <${RigPanel} extra=${extra} />
    <div class="body">${children}</div>
  </div>`;
}
