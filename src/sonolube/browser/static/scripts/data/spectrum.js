/**
 * An impedance spectrum: the equivalent circuit that fits it, or the stack of the rig, with residuals, resonances and
 * coupling.
 */
import {html, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {Button, Card, Refusal} from '../parts.js';
import {useApp} from '../state.js';
import {Choice, countsTo, Measured, stated} from './measured.js';

const RESIDUALS = [
  ['log-complex', 'logarithm of magnitude and phase'],
  ['log-magnitude', 'logarithm of magnitude'],
  ['linear-magnitude', 'magnitude'],
];
const USUAL = RESIDUALS[0][0];
const CIRCUITS = [
  ['plain', 'modes alone'],
  ['loss', 'dielectric loss'],
  ['leads', 'inductance and resistance of leads'],
  ['loss-and-leads', 'both'],
];
const SWEEP = ['sweep', 'Sweep of the file', 'the first one'];
const LEADS = ['series_resistance', 'Resistance of the leads', '0 ohm'];
const MAX_MODES = 8;
const RIG_NOTE =
  'The stack as it was fitted with the masses of the rig: free capacitance, stroke, stiffness and damping.';

/**
 * What measures a spectrum.
 * @param {import('./files.js').DataFile} file
 * @param {import('./files.js').Own} own
 * @returns {import('./files.js').Asked}
 */
export function taskOf(file, own) {
  const {branches, residual, sweep, stack, series_resistance, circuit} = own;
  const ofCircuit = {branches: branches && Number(branches), series_resistance, circuit};
  return {
    task: 'measure impedance',
    args: {files: file, ...stated({residual, sweep, ...(stack ? {stack_of: stack} : ofCircuit)})},
  };
}

/**
 * Whether a circuit is sought or the stack of the rig as it is now, which is given as a file.
 * @param {{own: import('./files.js').Own, set: import('./files.js').SetOwn}} props
 */
function Sought({own, set}) {
  const {
    state: {rig},
  } = useApp();
  const [note, setNote] = useState('');
  const take = async () => {
    const {content, failure} = await ask('api/take', {body: {form: 'toml', task: 'predict', arguments: {rig}}});
    const kept = content && (await ask('api/uploads', {raw: new Blob([content.text])}));
    if (kept?.content) set({stack: {name: content.name, upload: kept.content.upload}});
    setNote((failure ?? kept.failure)?.text);
  };
  return html`<div class="row scan-row">
    <${Choice}
      name="residual"
      label="The fit minimises"
      choices=${RESIDUALS}
      value=${own.residual ?? USUAL}
      onValue=${(value) => set({residual: value === USUAL ? null : value})}
    />
    ${
      !own.stack &&
      html`<${Choice}
        name="branches"
        label="Modes"
        choices=${countsTo('as many as are significant', MAX_MODES)}
        value=${own.branches ?? ''}
        onValue=${(value) => set({branches: value || null})}
      />`
    }
    ${
      !own.stack &&
      html`<${Choice}
        name="circuit"
        label="Beside the modes"
        choices=${[['', 'what the data demand'], ...CIRCUITS]}
        value=${own.circuit ?? ''}
        onValue=${(value) => set({circuit: value || null})}
      />`
    }
    <${Button} onClick=${take} data-test="fit-stack">
      ${own.stack ? 'Fit the stack of my rig of now' : 'Fit the stack of my rig'}
    <//>
    ${
      own.stack &&
      html`
        <${Button} onClick=${() => set({stack: null})} data-test="fit-circuit">Fit a circuit<//>
        <span class="hint">The stack of ${own.stack.name} is fitted, with what the rig was then.</span>
      `
    }
    <${Refusal} text=${note} role="alert" />
  </div>`;
}

/** @param {import('./files.js').FileProps} props */
export default function Spectrum({file, own, set}) {
  return html`<${Card} id="spectrum-title" title=${file.name}>
    <${Measured}
      file=${file}
      asked=${taskOf(file, own)}
      fields=${own.stack ? [SWEEP] : [SWEEP, LEADS]}
      own=${own}
      set=${set}
      rigNote=${RIG_NOTE}
      isFigureFirst=${true}
    >
      <${Sought} own=${own} set=${set} />
    <//>
  <//>`;
}
