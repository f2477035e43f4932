/** What several pages take beside the rig: materials of the bodies, and uploaded tables of own runs. */
import {html, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, useReply} from './api.js';
import {Labelled, refusedBy} from './fields.js';
import {Button, FileButton, Select} from './parts.js';
import {change} from './state.js';

const BODIES = [['pin', 'Material of the pin'], ['disc', 'Material of the disc']];
export const NOTHING = {};

/** Argument of a task by the text of a view that names an upload, which lasts as long as the workbench. */
export const uploadOf = (text) => ({name: text.slice(text.indexOf(' ') + 1), upload: text.split(' ')[0]});

/** Upload of a file that an entry of the view then names: what was refused of the last one, and what takes one. */
export function useFile(entry) {
  const [note, setNote] = useState('');
  const take = async (file) => {
    const {content, failure} = file ? await ask('api/uploads', {raw: file}) : {};
    if (content) change({view: {[entry]: `${content.upload} ${file.name}`}});
    setNote(failure?.text);
  };
  return [note, take];
}

/** Choices of the materials of pin and disc; `faultOf` gives the refusal of one. */
export function MaterialChoices({view, faultOf, isAsked = true}) {
  const known = useReply('materials', isAsked ? 'api/tasks/materials' : null, NOTHING);
  const names = Object.entries(known.content?.answer ?? {}).map(([name, {title}]) => [name, title]);
  return BODIES.map(([body, label]) => {
    const [id, chosen, fault] = [`material-${body}`, view[body], faultOf(body)];
    const isUnlisted = chosen && !names.some(([name]) => name === chosen);
    const choices = [['', 'as in the rig'], ...(isUnlisted ? [[chosen, chosen]] : []), ...names];
    return html`<${Labelled} key=${body} id=${id} label=${label} refusal=${fault}>
      <${Select} id=${id} choices=${choices} value=${chosen ?? ''} data-test=${`material:${body}`} ...${refusedBy(id, fault)}
        onChange=${(event) => change({view: {[body]: event.target.value || null}})} /><//>`;
  });
}

/** Buttons that choose a table of own runs, and leave it out. */
export const RunsChoice = ({view, onFile}) => html`<p class="row"><${FileButton} id="own-runs" accept=".csv,.txt" label="Own runs"
    onFile=${onFile} test="runs-file" data-test="choose-runs">${view.runs ? 'Choose other runs…' : 'Choose own runs…'}<//>
  ${view.runs && html`<strong class="grow">${uploadOf(view.runs).name}</strong>
    <${Button} kind="small" onClick=${() => change({view: {runs: null}})} data-test="remove-runs">leave out<//>`}</p>`;
