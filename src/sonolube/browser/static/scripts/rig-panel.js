/**
 * Left column: which rig, its contact as a form, and its other entries as fields; and the frame of a page that has it
 * beside its answer.
 */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {useReply} from './api.js';
import {ContactForm} from './contact-form.js';
import {Field, spreadKey} from './fields.js';
import {Button, FileButton, Loading, Refusal, Select, useDrop} from './parts.js';
import {addressOf, change, isOfTab, pack, pageNow, setEntry, settle, useApp} from './state.js';

/**
 * @import {RigField} from './fields.js'
 * @import {FieldEvent} from './parts.js'
 * @import {RigState} from './state.js'
 * @typedef {{title: string, source?: string, rigs: string[], studies: string[], maps: string[], fields: RigField[],
 *   sentence: import('./contact-form.js').Piece[], drawing: import('./contact-form.js').Parts}} RigView as the server
 *   shows a rig
 */

/** Last view that was read and its rig, so that a page that opens shows it at once. */
let last = {view: /** @type {RigView|null} */ (null), rig: /** @type {Partial<RigState>} */ ({})};

/**
 * The rig of the state as the server shows it: title, fields, drawing, assumptions, names of rigs; `view` is null where
 * refused.
 */
export function useRig() {
  const {
    state: {rig},
    isMoving,
  } = useApp();
  const asked = useRef(rig);
  if (!isMoving || rig.name !== asked.current.name) asked.current = rig; // values that move are not asked about
  const {content, failure, refused, isWaiting, of} = useReply('rig', rig.name ? 'api/rig' : null, {rig: asked.current});
  if (content) last = {view: content, rig: of.rig};
  const isOther = last.rig.name !== rig.name || last.rig.text !== rig.text;
  return {view: failure && isOther ? null : last.view, failure, refused, isWaiting};
}

/**
 * Text of an entry: as it was typed, else as the file has it.
 * @param {RigState} rig
 * @param {RigField} field
 */
const textOf = (rig, field) => rig.changes[field.key] ?? field.text;

/** @param {RigField} field */
const tableOf = (field) => field.key.slice(0, field.key.lastIndexOf('.'));

/** Pages that have the rig beside their answer. */
const BESIDE_RIG = ['predict', 'explore', 'design'];

/**
 * Make an example, or the rig that was opened, that of the state, without what belonged to the rig before.
 * @param {string} name
 */
export const chooseRig = (name) =>
  change({
    page: BESIDE_RIG.includes(pageNow()) ? undefined : 'predict',
    rig: {name, changes: {}},
    view: {pin: null, disc: null, runs: null, lost: null},
  });

/**
 * Chooser of a rig: the examples, the one that was opened, an own file.
 * @param {{view: RigView|null}} props
 */
export function RigChoice({view}) {
  const {state} = useApp();
  const own = state.rig.text !== undefined;
  const names = [
    ...new Set([...(own ? [state.rig.name] : []), ...(view?.rigs ?? last.view?.rigs ?? []), state.rig.name]),
  ].filter(Boolean);
  const choices = names.map((name) => (own && name === state.rig.name ? ['', `${name} (own file)`] : [name, name]));
  /** @param {FieldEvent} event */
  const choose = (event) => chooseRig(event.target.value);
  return html`<div class="rig-choice">
    <div class="row">
      <label for="rig-name" class="grow">Rig</label>
      <${FileButton} accept=".toml" label="Rig file" onFile=${openRig} test="rig-file" data-test="open-rig">Open…<//>
      <a class="button" href=${addressOf('new')}>New…</a>
    </div>
    <${Select} id="rig-name" choices=${choices} value=${own ? '' : state.rig.name} onChange=${choose} data-test="rig" />
    ${view && html`<p class="hint" data-test="rig-title">${view.title}</p>`}
    ${
      isOfTab(state.rig.text) &&
      html`<p class="hint" role="status" data-test="of-tab">
        This file is too long for a link: it stays in this tab only. Take it away as TOML to keep it.
      </p>`
    }
    <${Refusal}
      role="alert"
      data-test="lost"
      text=${
        state.view.lost &&
        `The file of ${state.view.lost} is not in this link and no longer in this browser: open it again.`
      }
    />
  </div>`;
}

/**
 * Make the text of a rig file the rig of the state, and go to a page.
 * @param {string} name
 * @param {string} text
 * @param {string} [page]
 * @returns {Promise<void>}
 */
export async function openRigText(name, text, page = undefined) {
  await pack(text);
  change({...(page && {page}), rig: {name, text, changes: {}}, view: {lost: null}});
}

/** @param {File} file */
const openRig = async (file) => openRigText(file.name.replace(/\.toml$/i, ''), await file.text());

/**
 * Rig with its drawing and fields; `extra` stands below those of the operating point.
 * @param {{extra?: any}} props
 */
export function RigPanel({extra}) {
  const {
    state: {rig},
  } = useApp();
  const {view, failure, refused} = useRig();
  const answered = failure && ['refused', 'busy'].includes(failure.kind) ? failure.faults : []; // else the head says it
  const faults = new Map([...answered, ...refused].map(({key, text}) => [key, text]));
  /** @param {string} key @param {string|null} text @param {boolean} isMoving */
  const onText = (key, text, isMoving) => setEntry(key, text, {replace: isMoving});
  const fields = view?.fields ?? [];
  const others = fields.filter((field) => !field.is_first);
  const placed = new Set(fields.flatMap((field) => [field.key, spreadKey(field.key)]));
  const homeless = [...faults].filter(([key]) => !placed.has(key));
  const isAll = others.some((field) => faults.has(field.key));
  const entries = useRef(null);
  useEffect(() => {
    if (isAll) entries.current.open = true; // an entry beyond the operating point is refused
  }, [isAll]);
  /** @param {RigField} field */
  const entryOf = (field) => ({
    key: `${rig.name} ${field.key}`,
    field,
    text: textOf(rig, field),
    spread: rig.changes[spreadKey(field.key)],
    isChanged: field.key in rig.changes,
    refusal: faults.get(field.key),
    spreadRefusal: faults.get(spreadKey(field.key)),
    onText,
    onSettle: settle,
  });
  /** @param {RigField[]} some */
  const list = (some) => some.map((field) => html`<${Field} ...${entryOf(field)} />`);
  const count = Object.keys(rig.changes).length;
  return html`<aside class="rig" aria-label="Rig" data-test="rig-panel">
    <${RigChoice} view=${view} />
    ${!view && !failure && html`<${Loading}>Reading the rig…<//>`}
    ${
      view &&
      html`<${ContactForm}
        key=${rig.name}
        sentence=${view.sentence}
        drawing=${view.drawing}
        entries=${fields.filter((field) => field.is_first).map(entryOf)}
      />`
    }
    ${homeless.map(([key, text]) => html`<${Refusal} key=${key} text=${text} role="alert" data-test="rig-refusal" />`)}
    ${
      count > 0 &&
      html`<${Button}
        kind="button is-quiet"
        onClick=${() => change({rig: {...rig, changes: {}}})}
        data-test="reset-all"
      >
        Take back ${count === 1 ? 'the change' : `all ${count} changes`}
      <//>`
    }
    ${extra}
    ${
      others.length > 0 &&
      html`<details ref=${entries} class="all-entries" data-test="all-entries">
        <summary>All entries</summary>
        ${[...new Set(others.map(tableOf))].map(
          (table) => html`<fieldset key=${table} class="fields">
            <legend>${table}</legend>
            ${list(others.filter((field) => tableOf(field) === table))}
          </fieldset>`,
        )}
      </details>`
    }
    ${view?.source && html`<p class="hint source">Source: ${view.source}</p>`}
  </aside>`;
}

/**
 * Frame of a page with the rig: the lead above its answer (sticky on narrow screens), the rig, the answer; `onFile`
 * takes what is dropped beside a rig.
 * @param {{lead: any, extra?: any, onFile?: (file: File) => void, children: any}} props
 */
export function Workspace({lead, extra, onFile, children}) {
  const isDropping = useDrop((files) =>
    files.forEach((file) => (/\.toml$/i.test(file.name) ? openRig : onFile)?.(file)),
  );
  return html`<div class="workspace">
    <div class="lead" id="answer" tabindex="-1">${lead}</div>
    <${RigPanel} extra=${extra} />
    <div class="body">${children}</div>
    ${isDropping && html`<div class="drop" aria-hidden="true">Drop the rig${onFile && ' or the runs'} here</div>`}
  </div>`;
}
