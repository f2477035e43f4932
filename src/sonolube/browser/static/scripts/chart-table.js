/** Numbers of a chart as tables, below it. */
import {html, useState} from '../vendor/htm-preact-3.1.1.js';

const MOST = 100; // rows shown before all are asked for

function NumberTable({table}) {
  const [isAll, setAll] = useState(false);
  const rows = isAll ? table.rows : table.rows.slice(0, MOST);
  const rest = table.rows.length - rows.length;
  return html`<div class="chart-table" tabindex="0" role="group" aria-label=${table.title || 'Numbers'}>
    <table class="table"><caption>${table.title || 'Numbers'}</caption>
      <thead><tr>${table.heads.map((head, at) => html`<th key=${at} scope="col">${head}</th>`)}</tr></thead>
      <tbody>${rows.map((row, at) => html`<tr key=${at}>${row.map((cell, place) => html`<td key=${place}>${cell}</td>`)}</tr>`)}</tbody>
    </table>
    ${rest > 0 && html`<button type="button" class="button is-quiet" onClick=${() => setAll(true)}>Show ${rest} further rows</button>`}
  </div>`;
}

/** @param {{tables?: {title: string, heads: string[], rows: string[][]}[], name: string}} props */
export function ChartTables({tables, name}) {
  const [isOpen, setOpen] = useState(false);
  if (!tables?.length) return null;
  return html`<details class="chart-numbers" onToggle=${(event) => setOpen(event.target.open)} data-test=${`numbers:${name}`}>
    <summary>Numbers</summary>
    ${isOpen && tables.map((table, at) => html`<${NumberTable} key=${at} table=${table} />`)}
  </details>`;
}
