/**
 * Page Lab: a protocol edited as a time line and gone through dry, run on the devices of this workbench, watched,
 * stopped, and its runs compared.
 */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Failure, RefusedNote} from '../answer.js';
import {ask, useReply} from '../api.js';
import {Labelled, TextField} from '../fields.js';
import {isAtWork, send, useLab} from '../lab/lab.js';
import {RunCard} from '../lab/run.js';
import {Runs, Shown} from '../lab/runs.js';
import {TimeLine} from '../lab/time-line.js';
import {Button, Card, FileButton, Loading, Select, Sheet, Warning} from '../parts.js';
import {RigChoice, useRig} from '../rig-panel.js';
import {change, pack, settle, unpack, useApp} from '../state.js';
import {save} from '../take-away.js';

/**
 * @import {Answer, Failure as Refused} from '../api.js'
 * @import {Laboratory} from '../lab/lab.js'
 * @import {Wrong} from '../lab/time-line.js'
 * @import {RigState, Texts} from '../state.js'
 * @typedef {{name: string, text?: string}} Named protocol
 * @typedef {Omit<Answer, 'of'> & {named: Named|undefined, edit: (changes: object) => Promise<boolean>, wrong:
 *   Wrong|null, isBusy: boolean}} ProtocolPlan the protocol with its time line and dry run
 */

const USUAL = 'map_test';
const TEXTS = [
  ['seed', 'Seed', '0'],
  ['tags', 'Tags', 'one, another'],
  ['facts', 'Facts', 'operator=Ann, humidity=45 %'],
];
/** @param {string} text */
const listOf = (text = '') =>
  text
    .split(',')
    .map((each) => each.trim())
    .filter(Boolean);

/**
 * Protocol of the view: its name, and its text where it was edited or opened; undefined while that is unpacked.
 * @param {Texts} view
 * @returns {Named|undefined}
 */
function useNamed({protocol: name = USUAL, steps}) {
  const [{of, text}, setFound] = useState({of: '', text: ''});
  useEffect(() => {
    if (steps)
      unpack(steps).then(
        (found) => setFound({of: steps, text: found ?? ''}),
        () => setFound({of: steps, text: ''}),
      );
  }, [steps]);
  if (!steps) return {name};
  return of === steps ? {name, text} : undefined;
}

/**
 * Make a text the protocol of the view.
 * @param {string} name
 * @param {string} text
 */
const keep = async (name, text) => change({view: {protocol: name, steps: await pack(text)}});

/**
 * The protocol of the view with its time line and dry run, and what edits it; `wrong` is the entry that was refused
 * last.
 * @param {Texts} view
 * @param {RigState} rig
 * @returns {ProtocolPlan}
 */
function usePlan(view, rig) {
  const named = useNamed(view);
  const of = JSON.stringify([named, rig]);
  const [edited, setEdited] = useState(null);
  const [wrong, setWrong] = useState(null);
  const [isEditing, setEditing] = useState(false);
  useEffect(() => setWrong(null), [of]);
  const own = edited?.of === of ? edited.content : null;
  const reply = useReply('protocol', named && rig.name && !own ? 'api/protocol' : null, {protocol: named, rig});
  /** @param {object} changes */
  const edit = async (changes) => {
    if (!named) return false;
    setEditing(true);
    const {content, failure} = await ask('api/edit_protocol', {body: {protocol: named, changes, rig}});
    const [[key, typed]] = Object.entries(changes);
    if (failure) setWrong({key, typed, text: failure.faults.map((fault) => fault.text).join(' ')});
    else {
      setWrong(null);
      setEdited({of: JSON.stringify([{name: named.name, text: content.text}, rig]), content});
      await keep(named.name, content.text);
    }
    setEditing(false);
    return !failure;
  };
  const {content, failure, refused} = own ? {content: own, failure: null, refused: []} : reply;
  return {
    content,
    failure,
    refused,
    named,
    edit,
    wrong,
    isBusy: isEditing || !named || reply.isWaiting,
  };
}

/**
 * What a run is begun with, and its start.
 * @param {{lab: Laboratory, view: Texts, rig: RigState, plan: ProtocolPlan, isFree: boolean}} props
 */
function Start({lab, view, rig, plan: {named, content, failure: fault, wrong, isBusy}, isFree}) {
  const isPossible = content?.refusals.length === 0;
  const [failure, setFailure] = useState(/** @type {Refused|null} */ (null));
  const [isAnyway, setAnyway] = useState(false);
  const isVirtual = lab.devices.kind === 'virtual';
  const start = async () => {
    const facts = Object.fromEntries(
      listOf(view.facts).map((each) =>
        each
          .split(/=(.*)/s)
          .slice(0, 2)
          .map((part) => part.trim()),
      ),
    );
    const body = {
      protocol: named,
      rig,
      tags: listOf(view.tags),
      facts,
      anyway: isAnyway,
      ...(isVirtual && {seed: Number(view.seed || 0)}),
    };
    setFailure((await send('start', body, {isHeld: true})).failure ?? null);
  };
  return html`<section aria-labelledby="start-title" data-test="start-card">
    <h2 id="start-title">Run on ${lab.devices.title}</h2>
    <div class="fields two">
      ${TEXTS.filter(([name]) => isVirtual || name !== 'seed').map(
        ([name, label, usual]) => html`<${Labelled} key=${name} id=${`start-${name}`} label=${label}>
          <${TextField}
            id=${`start-${name}`}
            text=${view[name] ?? ''}
            placeholder=${usual}
            onSettle=${settle}
            data-test=${`start:${name}`}
            onText=${(text, isMoving) => !isMoving && change({view: {[name]: text.trim() || null}})}
          />
        <//>`,
      )}
    </div>
    ${
      !isPossible &&
      html`<label class="check">
        <input type="checkbox" checked=${isAnyway} onChange=${() => setAnyway(!isAnyway)} data-test="anyway" /> Run it
        although the dry run says that it is impossible
      </label>`
    }
    <${Failure} failure=${failure} />
    <p class="row">
      <${Button}
        kind="button is-main"
        onClick=${start}
        disabled=${isBusy || fault || wrong || !isFree || !(isPossible || isAnyway)}
        data-test="start"
      >
        Start the run
      <//>
      ${wrong && html`<span class="refusal">An entry of the protocol is refused: mend it first.</span>`}
    </p>
  </section>`;
}

/**
 * Choice of a protocol, its time line, and the dry run beside it.
 * @param {{lab: Laboratory, plan: ProtocolPlan, start: any}} props
 */
function Plan({lab, plan, start}) {
  const {named, content, failure, refused, edit, wrong, isBusy} = plan;
  const isOwn = named?.text !== undefined;
  /** @type {string[]} */
  const refusals = content?.refusals ?? [];
  const choices = lab.protocols.map(({name, title}) => [name, title]);
  return html`<${Card} id="plan-title" title="Protocol" data-test="plan">
    <${RigChoice} view=${useRig().view} />
    <label for="protocol">Protocol</label>
    <div class="row">
      <${Select}
        id="protocol"
        class="grow"
        choices=${isOwn ? [['', `${content?.title ?? named.name} (own)`], ...choices] : choices}
        value=${isOwn ? '' : named?.name}
        onChange=${(event) => change({view: {protocol: event.target.value, steps: null}})}
        data-test="protocol"
      />
      <${FileButton}
        accept=".toml"
        label="Protocol file"
        onFile=${async (file) => keep(file.name.replace(/\.toml$/i, ''), await file.text())}
        test="protocol-file"
        data-test="open-protocol"
      >
        Open…
      <//>
      <${Button}
        onClick=${() => save({name: `${named?.name}.toml`, kind: 'application/toml', text: content.text})}
        disabled=${!content}
        data-test="save-protocol"
      >
        Save as TOML
      <//>
    </div>
    <${Failure} failure=${failure} />
    <${RefusedNote} refused=${refused} />
    ${!content && !failure && html`<${Loading}>Reading the protocol…<//>`}
    ${
      content &&
      html`
        <p class="hint">${content.source}</p>
        <${TimeLine} protocol=${content} edit=${edit} wrong=${wrong} start=${start}>
          <section aria-labelledby="dry-run-title" aria-busy=${isBusy} data-test="dry-run">
            <h2 id="dry-run-title">Dry run</h2>
            ${
              refusals.length > 0 &&
              html`<${Warning} data-test="impossible">
                <strong>Impossible on this rig:</strong>
                ${refusals.map((line) => html`<p key=${line}>${line}</p>`)}
              <//>`
            }
            <${Shown} answer=${content.dry_run} of=${content.text} />
          </section>
        <//>
      `
    }
  <//>`;
}

/**
 * Who holds the laboratory, and its last run where that was lost.
 * @param {{lab: Laboratory}} props
 */
function Holder({lab}) {
  const [failure, setFailure] = useState(null);
  /** @param {string} what @param {object} [more] @param {boolean} [isHeld] */
  const to = async (what, more, isHeld) => setFailure((await send(what, more, {isHeld})).failure ?? null);
  const {is_me: isMe, is_free: isFree} = lab.holder;
  return html`
    ${
      lab.lost &&
      html`<${Warning} data-test="lost-run">
        <strong>${lab.lost.text}</strong>
        <p>
          <${Button} onClick=${() => to('recover', {is_off: true}, true)} data-test="recover">
            I have cut the power and seen that motor and drive are off
          <//>
        </p>
      <//>`
    }
    <p class="row">
      <span role="status" data-test="holder">
        ${
          isMe
            ? 'This tab holds the laboratory.'
            : isFree
              ? 'Nobody holds the laboratory.'
              : 'Watching; the laboratory is held by another tab. The stop button works here too.'
        }
      </span>
      ${
        (isMe || isFree) &&
        html`<${Button} kind="small" onClick=${() => to(isMe ? 'release' : 'hold')} data-test="hold">
          ${isMe ? 'release it' : 'hold it'}
        <//>`
      }
    </p>
    <${Failure} failure=${failure} />
  `;
}

export default function Lab() {
  const {
    state: {view, rig},
  } = useApp();
  const lab = useLab();
  const plan = usePlan(view, rig);
  if (!lab) return html`<${Sheet} title="Lab"><${Loading}>Reading the state of the laboratory…<//><//>`;
  const {run} = lab;
  const isHolder = lab.holder.is_me;
  return html`<${Sheet} title="Run a test by protocol">
    <p class="notice is-warning" data-test="safety">${lab.safety}</p>
    <${Holder} lab=${lab} />
    ${run && html`<${RunCard} run=${run} devices=${lab.devices} isHolder=${isHolder} ask=${send} />`}
    <${Plan}
      lab=${lab}
      plan=${plan}
      start=${html`<${Start}
        lab=${lab}
        view=${view}
        rig=${rig}
        plan=${plan}
        isFree=${!lab.lost && !isAtWork(run) && (isHolder || lab.holder.is_free)}
      />`}
    />
    <${Runs} turn=${`${run?.id} ${isAtWork(run)}`} />
  <//>`;
}
