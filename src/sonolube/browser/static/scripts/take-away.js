/** What a page gives to take away: the link, and files that give the numbers on screen. */
import {html, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask} from './api.js';
import {Button, Caret, useMenu} from './parts.js';

const FORMS = [
  ['command', 'Command line', 'copy'],
  ['python', 'Python', 'copy'],
  ['toml', 'Rig file (TOML)', 'save'],
  ['notebook', 'Notebook', 'save'],
  ['csv', 'Table (CSV)', 'save'],
  ['svg', 'Figure (SVG)', 'save'],
  ['report', 'Report (HTML)', 'save'],
];

/** What the page shows. @type {{task: string, args: object}|null} */
let offered = null;

/**
 * State the task and arguments whose answer a page shows; call it in an effect, whose end takes it back.
 * @param {string} task
 * @param {object} args
 * @returns {() => void}
 */
export function offer(task, args) {
  const mine = {task, args};
  offered = mine;
  return () => {
    if (offered === mine) offered = null;
  };
}

/**
 * Save a file that the workbench has sent.
 * @param {{name: string, kind: string, text?: string, base64?: string}} file
 */
export function save({name, kind, text, base64}) {
  const content = base64 === undefined ? (text ?? '') : Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const address = URL.createObjectURL(new Blob([content], {type: kind}));
  const link = document.createElement('a');
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Menu "Take away". */
export function TakeAway() {
  const [shown, setShown] = useState(null);
  const [note, setNote] = useState('');
  const {place, isOpen, toggle} = useMenu();
  /** @param {string} what @param {string} text */
  const copy = async (what, text) => {
    setShown({what, text});
    const done = await navigator.clipboard?.writeText(text).then(
      () => true,
      () => false,
    );
    setNote(done ? `${what}: copied.` : `${what}: copy it from the field below.`);
  };
  /** @param {string} form @param {string} label @param {string} how */
  const take = async (form, label, how) => {
    setShown(null);
    setNote(`${label}: being made…`);
    const {content, failure} = await ask('api/take', {body: {form, task: offered?.task, arguments: offered?.args}});
    if (failure) setNote(failure.faults[0]?.text || failure.text);
    else if (how === 'copy') await copy(label, content.text);
    else {
      save(content);
      setNote(`${content.name}: saved.`);
    }
  };
  const open = () => {
    toggle();
    setNote('');
    setShown(null);
  };
  return html`<div class="take" ref=${place}>
    <${Button} aria-expanded=${isOpen} aria-haspopup="true" onClick=${open} data-test="take">
      Take away <${Caret} />
    <//>
    ${
      isOpen &&
      html`<div class="menu" role="group" aria-label="Take away">
        <${Button} kind="menu-item" onClick=${() => copy('Link', location.href)} data-test="take:link">
          Link to this screen
        <//>
        ${
          offered &&
          FORMS.map(
            ([form, label, how]) => html`<${Button}
              key=${form}
              kind="menu-item"
              onClick=${() => take(form, label, how)}
              data-test=${`take:${form}`}
            >
              ${label}
              <span class="hint">${how}</span>
            <//>`,
          )
        }
        ${!offered && html`<p class="hint">This page has no answer to take away.</p>`}
        ${
          shown &&
          html`<textarea
            readonly
            rows="4"
            aria-label=${shown.what}
            onFocus=${(event) => event.target.select()}
            data-test="taken"
          >${shown.text}</textarea>`
        }
        <p class="hint" role="status" data-test="take-note">${note}</p>
      </div>`
    }
  </div>`;
}
