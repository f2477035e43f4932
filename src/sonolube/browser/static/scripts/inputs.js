/** What several pages take beside the rig: materials of the bodies, and uploaded tables of own runs. */
import {html, useRef} from '../vendor/htm-preact-3.1.1.js';
import {upload, useReply} from './api.js';
import {change} from './state.js';

const BODIES = [['pin', 'Material of the pin'], ['disc', 'Material of the disc']];
export const NOTHING = {};

/** Text of a view that names an upload, and back as the argument of a task; it lasts as long as the workbench. */
const uploadText = ({name, upload: id}) => `${id} ${name}`;
export const uploadOf = (text) => ({name: text.slice(text.indexOf(' ') + 1), upload: text.split(' ')[0]});

/** Upload a file, and name it in the view; returns what is refused. */
export async function takeFile(file, entry = 'runs') {
  if (!file) return '';
  const {file: uploaded, failure} = await upload(file);
  if (uploaded) change({view: {[entry]: uploadText(uploaded)}});
  return failure?.text ?? '';
}

/** Choices of the materials of pin and disc; `faultOf` gives the refusal of one. */
export function MaterialChoices({view, faultOf, isAsked = true}) {
  const known = useReply('materials', isAsked ? 'api/tasks/materials' : null, NOTHING);
  const names = Object.entries(known.content?.answer ?? {}).map(([name, {title}]) => [name, title]);
  return BODIES.map(([body, label]) => {
    const [id, chosen, fault] = [`material-${body}`, view[body], faultOf(body)];
    const isUnlisted = chosen && !names.some(([name]) => name === chosen);
    const choices = [['', 'as in the rig'], ...(isUnlisted ? [[chosen, chosen]] : []), ...names];
    return html`<div key=${body} class="field"><label for=${id}>${label}</label>
      <select id=${id} value=${chosen ?? ''} data-test=${`material:${body}`} aria-describedby=${fault ? `${id}-refusal` : undefined}
        onChange=${(event) => change({view: {[body]: event.target.value || null}})}>
        ${choices.map(([name, title]) => html`<option key=${name} value=${name} selected=${name === (chosen ?? '')}>${title}</option>`)}
      </select>
      ${fault && html`<p class="refusal" id=${`${id}-refusal`}>${fault}</p>`}</div>`;
  });
}

/** Buttons that choose a table of own runs, and leave it out. */
export function RunsChoice({view, onFile}) {
  const chooser = useRef(null);
  return html`<p class="row"><button type="button" class="button" id="own-runs" onClick=${() => chooser.current.click()}
      data-test="choose-runs">${view.runs ? 'Choose other runs…' : 'Choose own runs…'}</button>
    ${view.runs && html`<strong class="grow">${uploadOf(view.runs).name}</strong><button type="button" class="small"
      onClick=${() => change({view: {runs: null}})} data-test="remove-runs">leave out</button>`}</p>
    <input type="file" accept=".csv,.txt" class="hidden" tabindex="-1" aria-label="Own runs" ref=${chooser}
      onChange=${(event) => onFile(event.target.files[0])} data-test="runs-file" />`;
}
