/** Page New rig: the questions of the task `new`, whose answer is a first rig file with what is least known of it. */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, Failure} from '../answer.js';
import {useReply} from '../api.js';
import {Labelled, NOTHING, printed, TextField, understood, uploadOf, useFile} from '../fields.js';
import {Button, capital, Card, classes, Loading, Refusal, Sheet, words} from '../parts.js';
import {openRigText} from '../rig-panel.js';
import {change, settle, useApp} from '../state.js';

/**
 * @import {Fault} from '../api.js'
 * @import {Texts} from '../state.js'
 * @typedef {{description: string, 'x-unit'?: string, 'x-customary-unit'?: string}} Schema of an argument
 */

const PATH = '/api/tasks/new';
const EITHER = ['amplitude', 'actuator']; // one of them is needed
const FIRST = ['amplitude', 'actuator', 'voltage'];
const FILES = ['scan', 'pin_scan'];
/** @type {Texts} */
const LISTS = {pin: 'materials', disc: 'materials', actuator: 'actuators'};
const NAME = 'name';
const OF_NUMBERS = / A number(?: in [^,]+)?, or text: /; // what a description goes on with for programs

/**
 * Argument of a view: an upload for a file, else its text.
 * @param {string} name
 * @param {string} text
 * @returns {any}
 */
const argument = (name, text) => (FILES.includes(name) ? uploadOf(text) : text);

/** @param {string} name @returns {(text: string, isMoving: boolean) => void} */
const give = (name) => (text, isMoving) => change({view: {[name]: text || null}}, {replace: isMoving});

/**
 * One question.
 * @param {{name: string, schema: Schema, view: Texts, isNeeded: boolean, refusal?: string, list?: string}} props
 */
function Question({name, schema, view, isNeeded, refusal, list}) {
  const id = `new-${name}`;
  const [note, take] = useFile(name);
  const [draft, setDraft] = useState(/** @type {string|null} */ (null));
  const unit = schema['x-customary-unit'] ?? schema['x-unit'];
  const typed = draft ?? view[name] ?? '';
  const read = unit === undefined ? '' : printed(understood(typed, unit));
  const isRead = read && read !== typed && !refusal;
  const described = [`${id}-help`, refusal && `${id}-refusal`].filter(Boolean).join(' ');
  return html`<div class=${classes('field', {'is-refused': refusal})}>
    <div class="field-head">
      <label for=${id}>${capital(words(name))}${isNeeded && html` <span class="tag">needed</span>`}</label>
      ${isRead && html`<output class="read" for=${id} data-test=${`read:${name}`}>${read}</output>`}
    </div>
    <div class="field-row">
      ${
        FILES.includes(name)
          ? html`<input
            type="file"
            id=${id}
            onChange=${(event) => take(event.target.files[0])}
            aria-describedby=${described}
            data-test=${`new:${name}`}
          />`
          : html`<${TextField}
            id=${id}
            text=${view[name] ?? ''}
            unit=${unit}
            onDraft=${setDraft}
            onText=${give(name)}
            onSettle=${settle}
            list=${list}
            aria-describedby=${described}
            aria-invalid=${refusal ? 'true' : undefined}
            data-test=${`new:${name}`}
          />`
      }
    </div>
    ${
      FILES.includes(name) &&
      view[name] &&
      html`<p class="row">
        <span class="grow">${argument(name, view[name]).name}</span>
        <${Button} kind="small" onClick=${() => give(name)('', false)}>leave out<//>
      </p>`
    }
    <p class="hint" id=${`${id}-help`}>${schema.description.split(OF_NUMBERS)[0]}</p>
    <${Refusal} text=${refusal || note} id=${`${id}-refusal`} data-test=${`refusal:${name}`} />
  </div>`;
}

/**
 * Field that a refusal is of: by its key, else by the name with which its sentence begins.
 * @param {Fault} fault
 * @param {string[]} names
 */
const fieldOf = (fault, names) =>
  names.includes(fault.key) ? fault.key : (names.find((name) => new RegExp(`^${name}\\b`).test(fault.text)) ?? '');

/**
 * The rig that was made.
 * @param {{answer: import('../answer.js').Content, name: string, isDim: boolean, isRefused: boolean}} props
 */
function Made({answer, name, isDim, isRefused}) {
  const {text, rig} = answer.answer;
  const [isWanted, want] = useState(false);
  useEffect(() => {
    if (isWanted && !isDim) openRigText(name, text, 'predict');
    if (isRefused) want(false);
  }, [isWanted, isDim, isRefused, text]);
  if (isRefused) {
    return html`<${Card} id="made-title" title="No rig yet" data-test="made">
      <p class="row">
        <${Button} kind="button is-main" disabled data-test="use-rig">Predict with this rig<//>
        <span class="hint">It is made as soon as nothing is refused.</span>
      </p>
    <//>`;
  }
  return html`<${Card} id="made-title" title=${rig} isDim=${isDim} data-test="made">
    <p class="row">
      <${Button} kind="button is-main" onClick=${() => want(true)} data-test="use-rig">
        Predict with this rig
      <//>
      <span class="hint">Every entry can be changed there, and the file taken away.</span>
    </p>
    <${Blocks} blocks=${answer.blocks.filter((block) => block.kind !== 'verbatim' && block.text !== rig)} />
    <details><summary>Rig file</summary><pre class="verbatim" tabindex="0" aria-label="Rig file">${text}</pre></details>
    <${Caveats} answer=${answer} isMoving=${false} of="" hasFields=${false} />
  <//>`;
}

export default function NewRig() {
  const {
    state: {view},
  } = useApp();
  const description = useReply('description', 'api/description', undefined);
  const materials = useReply('materials', 'api/materials', NOTHING);
  const actuators = useReply('actuators', 'api/tasks/actuators', NOTHING);
  /** @type {{properties: Record<string, Schema>, required: string[]}|undefined} */
  const schema = description.content?.paths[PATH].post.requestBody.content['application/json'].schema;
  const names = Object.keys(schema?.properties ?? {});
  const args = Object.fromEntries(names.filter((name) => view[name]).map((name) => [name, argument(name, view[name])]));
  const needed = (schema?.required ?? []).filter((name) => !args[name]);
  const isReady = schema && !needed.length && EITHER.some((name) => args[name]);
  const {content, failure, isWaiting} = useReply('new', isReady ? 'api/tasks/new' : null, args);
  if (!schema) {
    return html`<${Sheet} title="New rig">
      <${Failure} failure=${description.failure} />
      ${!description.failure && html`<${Loading}>Reading the questions…<//>`}
    <//>`;
  }
  const refused =
    isReady && failure
      ? {...failure, faults: failure.faults.map((fault) => ({...fault, key: fieldOf(fault, names)}))}
      : null;
  const faults = new Map(refused?.faults.map((fault) => [fault.key, fault.text]));
  const first = [...schema.required, ...FIRST];
  const others = names.filter((name) => !first.includes(name));
  /** @param {string[]} some */
  const ask = (some) =>
    some.map(
      (name) => html`<${Question}
        key=${name}
        name=${name}
        schema=${schema.properties[name]}
        view=${view}
        isNeeded=${schema.required.includes(name) || EITHER[0] === name}
        refusal=${faults.get(name)}
        list=${LISTS[name] && `known-${LISTS[name]}`}
      />`,
    );
  const missing = [...needed, ...(EITHER.some((name) => args[name]) ? [] : [EITHER.join(' or ')])];
  return html`<div class="page">
    <div id="answer" tabindex="-1">
      <h1 class="statement">A first rig from what is known before a test</h1>
      <p class="hint">
        A number without a unit takes the usual one, which is shown while you type. What is not known is taken from
        published tests, and stated as least known.
      </p>
    </div>
    <datalist id="known-materials">
      ${Object.entries(materials.content ?? {}).map(
        ([name, title]) => html`<option key=${name} value=${name}>${title}</option>`,
      )}
    </datalist>
    <datalist id="known-actuators">
      ${Object.keys(actuators.content?.answer ?? {}).map((name) => html`<option key=${name} value=${name} />`)}
    </datalist>
    <div class="columns">
      <form class="card" onSubmit=${(event) => event.preventDefault()} aria-label="Questions">
        <div class="fields two">${ask(first)}</div>
        <details>
          <summary>Surfaces and what else is known</summary>
          <div class="fields two">${ask(others)}</div>
        </details>
        <${Labelled} id="new-rig-name" label="Name of the rig">
          <${TextField}
            id="new-rig-name"
            text=${view[NAME] ?? ''}
            placeholder="my-rig"
            data-test="new:name"
            onText=${give(NAME)}
            onSettle=${settle}
          />
        <//>
      </form>
      <div class="stack">
        ${
          missing.length > 0 &&
          html`<p class="notice" role="status" data-test="missing">Still needed: ${missing.map(words).join(', ')}.</p>`
        }
        <${Failure} failure=${refused} shown=${names} />
        ${isWaiting && !content && html`<${Loading}>Making the rig…<//>`}
        ${
          content &&
          html`<${Made}
            answer=${content}
            name=${view[NAME]?.trim() || 'my-rig'}
            isDim=${isWaiting}
            isRefused=${!isReady || Boolean(failure)}
          />`
        }
      </div>
    </div>
  </div>`;
}
