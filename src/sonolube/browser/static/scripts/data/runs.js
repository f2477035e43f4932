/** A table of runs: its columns, and its use in predictions. */
import {html} from '../../vendor/htm-preact-3.1.1.js';
import {Columns} from './columns.js';
import {Use} from './use.js';

/** @param {import('./files.js').FileProps} props */
export default function Runs({file, own, set, info}) {
  return html`
    <${Columns} file=${file} own=${own} set=${set} info=${info} />
    <${Use} source=${{table: file, ...(own.mapping && {mapping: own.mapping})}} />
  `;
}
