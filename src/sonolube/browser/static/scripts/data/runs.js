/** A table of runs: its columns, and its use in predictions. */
import {html} from '../../vendor/htm-preact-3.1.1.js';
import {TextTable} from '../answer.js';
import {Card} from '../parts.js';

export default function Runs({file, info}) {
  return html`<${Card} id="runs-of-file" title=${file.name}>
    <${TextTable} heads=${['Column', 'Quantity', 'Cells']} rows=${info.columns.map(({label, statement, cells}) => [label, statement, cells.join('; ')])} /><//>`;
}
