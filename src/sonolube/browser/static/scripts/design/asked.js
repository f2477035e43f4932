/** Fields of a task by its description: names, words, defaults and choices are those of terminal and Python. */
import {html} from '../../vendor/htm-preact-3.1.1.js';
import {useReply} from '../api.js';
import {Labelled, refusedBy, split, TextField} from '../fields.js';
import {capital, Refusal, Select, words} from '../parts.js';
import {change, settle} from '../state.js';

/**
 * @import {Failure} from '../api.js'
 * @import {FieldEvent} from '../parts.js'
 * @import {Texts} from '../state.js'
 * @typedef {{type?: string|string[], enum?: (string|null)[], default?: any, description: string, 'x-unit'?: string}}
 *   Schema of an argument
 * @typedef {Record<string, Schema>} Schemas by the names of the arguments
 */

/**
 * Arguments of a task with what is said of each; null until they are read.
 * @param {string} task
 * @returns {{schema: Schemas|null, failure: Failure|null}}
 */
export function useSchema(task) {
  const {content, failure} = useReply('description', 'api/description', undefined);
  const body = content?.paths[`/api/tasks/${task.replaceAll(' ', '/')}`].post.requestBody;
  return {schema: body?.content['application/json'].schema.properties ?? null, failure};
}

/** @param {Schema} schema */
const kindsOf = (schema) => [schema.type].flat();

/**
 * Argument of a text of the view: a flag, a list or a number where the task takes nothing else.
 * @param {Schema} schema
 * @param {string} text
 */
function argument(schema, text) {
  const kinds = kindsOf(schema);
  if (kinds.includes('boolean')) return text === 'yes';
  if (kinds.includes('array'))
    return text
      .split(',')
      .map((each) => each.trim())
      .filter(Boolean);
  return !kinds.includes('string') && !schema.enum && split(text)?.rest.trim() === '' ? Number(text) : text;
}

/**
 * Arguments that the view gives, each under its name after a prefix.
 * @param {string} prefix
 * @param {string[]} names
 * @param {Schemas} schema
 * @param {Texts} view
 * @returns {Record<string, any>}
 */
export const given = (prefix, names, schema, view) =>
  Object.fromEntries(
    names
      .map((name) => [name, view[`${prefix}.${name}`]])
      .filter(([, text]) => text)
      .map(([name, text]) => [name, argument(schema[name], text)]),
  );

/**
 * Failure whose faults have the argument of which each is, by its key or by the name with which its sentence begins.
 * @param {Failure|null} failure
 * @param {string[]} names
 */
export function withNames(failure, names) {
  const longest = [...names].sort((one, other) => other.length - one.length);
  /** @param {import('../api.js').Fault} fault */
  const keyOf = ({key, text}) =>
    names.includes(key) ? key : (longest.find((name) => new RegExp(`^${name}\\b`).test(text)) ?? key);
  return failure && {...failure, faults: failure.faults.map((fault) => ({...fault, key: keyOf(fault)}))};
}

/**
 * Field of one argument, its entry of the view after a prefix.
 * @param {{prefix: string, name: string, schema: Schema, label?: string, view: Texts, fault?: string}} properties
 */
function Asked({prefix, name, schema, label = capital(words(name)), view, fault}) {
  const [entry, id] = [`${prefix}.${name}`, `${prefix}-${name}`];
  const text = view[entry] ?? '';
  /** @param {string} next @param {boolean} isMoving */
  const give = (next, isMoving) => change({view: {[entry]: next.trim() || null}}, {replace: isMoving});
  const described = [fault && `${id}-refusal`, `${id}-help`].filter(Boolean).join(' ');
  const shared = {id, 'data-test': entry, ...refusedBy(id, fault), 'aria-describedby': described};
  const help = html`<p class="hint" id=${`${id}-help`}>${schema.description.split(/(?<=\.) A number/)[0]}</p>`;
  if (kindsOf(schema).includes('boolean')) {
    /** @param {FieldEvent} event */
    const toggle = (event) =>
      change({view: {[entry]: event.target.checked === schema.default ? null : event.target.checked ? 'yes' : 'no'}});
    return html`<div class="field">
      <label class="check">
        <input type="checkbox" checked=${text ? text === 'yes' : schema.default} onChange=${toggle} ...${shared} />
        ${label}
      </label>
      ${help}
      <${Refusal} text=${fault} id=${`${id}-refusal`} />
    </div>`;
  }
  const choices = schema.enum?.map((each) => [each ?? '', capital(each ?? 'none')]);
  return html`<${Labelled} id=${id} label=${label} refusal=${fault}>
    ${
      choices
        ? html`<${Select}
          choices=${choices}
          value=${text || (schema.default ?? '')}
          ...${shared}
          onChange=${(event) => give(event.target.value, false)}
        />`
        : html`<${TextField}
          text=${text}
          unit=${schema['x-unit']}
          placeholder=${schema.default?.length === 0 ? '' : (schema.default ?? '')}
          onText=${give}
          onSettle=${settle}
          ...${shared}
        />`
    }
    ${help}
  <//>`;
}

/**
 * Fields of some arguments.
 * @param {{names: string[], prefix: string, schema: Schemas, labels?: Texts, view: Texts, faultOf: (name: string) =>
 *   string|undefined}} properties
 */
export const Fields = ({names, schema, labels = {}, faultOf, ...rest}) =>
  html`<div class="fields two">
    ${names.map(
      (name) => html`<${Asked}
        key=${name}
        name=${name}
        schema=${schema[name]}
        label=${labels[name]}
        fault=${faultOf(name)}
        ...${rest}
      />`,
    )}
  </div>`;

/** @type {Texts} */
const USUAL = {'drive.frequency': 'a fifth either way', 'drive.waveform': 'as in the rig; or sine, square'};
/** @param {import('../fields.js').RigField} field */
const isVaried = ({key, lowest}) => key in USUAL || (key.startsWith('structure.') && lowest != null);

/**
 * What may vary: a range of the frequency and of each entry of the structure, and waveforms.
 * @param {{fields: import('../fields.js').RigField[], view: Texts, fault?: string}} properties
 */
export const Ranges = ({fields, view, fault = ''}) => html`<fieldset>
  <legend>What may vary, as a range</legend>
  <div class="fields two">
    ${fields.filter(isVaried).map(({key, label, text}) => {
      const [id, entry, refusal] = [`over-${key}`, `over.${key}`, fault.includes(key) ? fault : undefined];
      return html`<${Labelled} key=${key} id=${id} label=${label} refusal=${refusal}>
        <${TextField}
          id=${id}
          text=${view[entry] ?? ''}
          placeholder=${USUAL[key] ?? text}
          onText=${(next, isMoving) => !isMoving && change({view: {[entry]: next.trim() || null}})}
          onSettle=${settle}
          data-test=${entry}
          ...${refusedBy(id, refusal)}
        />
      <//>`;
    })}
  </div>
  <p class="hint">Such as 80g:150g. What is left empty stays as in the rig.</p>
</fieldset>`;
