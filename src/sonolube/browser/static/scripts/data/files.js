/**
 * Files of the page Data: those of the view, what was set for each, and what was measured of each.
 *
 * @typedef {{name: string, upload: string}} DataFile an argument of a task as it is
 * @typedef {{task: string, args: object}} Asked
 * @typedef {Record<string, any>} Own what was set for a file, by name
 * @typedef {(partial: Own, options?: import('../state.js').ChangeOptions) => void} SetOwn sets it; null removes
 * @typedef {{label: string, cells: string[], texts: string[], statement: string, is_asked?: boolean}} Column
 * @typedef {{kind: string, reason?: string, columns: Column[], quantities: [string, string, string][], rows: Texts,
 *   begin: number, end: number, samples: number, sample_rate?: number, axis: {name: string, label: string, unit:
 *   string}, channels: {name: string, label: string, unit: string}[]}} Info what a file is, and of a recording its
 *   channels
 * @typedef {{file: DataFile, own: Own, set: SetOwn, info: Info, asked: Asked|null}} FileProps of the parts of the page
 */
import {ask, taskPath, useReply} from '../api.js';
import {NOTHING, uploadOf} from '../fields.js';
import {change, present} from '../state.js';
/** @import {Texts} from '../state.js' */

/** @param {Texts} view @returns {DataFile[]} */
export const filesOf = (view) => (view.files ?? '').split('\n').filter(Boolean).map(uploadOf);

/** Settings of all files by their uploads. @param {Texts} view @returns {Record<string, Own>} */
export function settingsOf(view) {
  try {
    return JSON.parse(view.own ?? '{}');
  } catch {
    return {}; // a link that was cut off
  }
}

/**
 * Change settings of a file; null removes one. Options as of `change`.
 * @param {Texts} view
 * @param {DataFile} file
 * @param {Own} partial
 * @param {import('../state.js').ChangeOptions} [options]
 */
export function setOwn(view, file, partial, options) {
  const every = settingsOf(view);
  const own = present({...every[file.upload], ...partial});
  change({view: {own: JSON.stringify({...every, [file.upload]: own})}}, options);
}

/**
 * Upload files, and show the first of them.
 * @param {Texts} view
 * @param {File[]} given
 * @returns {Promise<string>} why one was not taken
 */
export async function addFiles(view, given) {
  const lines = [];
  let note = '';
  for (const file of given) {
    const {content, failure} = await ask('api/uploads', {raw: file});
    if (failure) note = `${file.name}: ${failure.text}`;
    else lines.push(`${content.upload} ${file.name}`);
  }
  if (lines.length)
    change({
      view: {
        files: [...(view.files ?? '').split('\n').filter(Boolean), ...lines].join('\n'),
        file: uploadOf(lines[0]).upload,
      },
    });
  return note;
}

/** Leave a file out. @param {Texts} view @param {DataFile} file */
export function dropFile(view, {upload}) {
  const {[upload]: gone, ...own} = settingsOf(view);
  const files = filesOf(view)
    .filter((each) => each.upload !== upload)
    .map((each) => `${each.upload} ${each.name}`);
  change({
    view: {
      files: files.join('\n') || null,
      own: Object.keys(own).length ? JSON.stringify(own) : null,
      file: view.file === upload ? null : view.file,
    },
  });
}

/**
 * What an uploaded file is: kind, columns, and of a recording its length and channels; null asks nothing.
 * @param {DataFile|null} file
 * @param {Own} own
 */
export const useInfo = (file, own) =>
  useReply(
    `file ${file?.upload}`,
    file && 'api/file',
    file ? {file, ...(own.mapping && {mapping: own.mapping})} : NOTHING,
  );

/**
 * Answer of the task that measures a file, asked once for all who show it; null asks nothing.
 * @param {DataFile} file
 * @param {Asked|null} asked
 */
export const useMeasured = (file, asked) =>
  useReply(`measured ${file.upload}`, asked && taskPath(asked.task), asked?.args ?? NOTHING);

/** A mapping of columns as an argument of a task, by its text. @param {string|null} [text] @returns {object} */
export const mappingOf = (text) =>
  text ? {mapping: {name: 'mapping.toml', content: btoa(String.fromCharCode(...new TextEncoder().encode(text)))}} : {};
