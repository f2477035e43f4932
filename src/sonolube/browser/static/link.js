/** Let this address in by the pasted link, and read it again with its fragment. */
document.querySelector('form')?.addEventListener('submit', async (event) => {
  event.preventDefault();
  const link = /** @type {HTMLInputElement} */ (document.getElementById('token')).value;
  const token = /[?&]token=([\w-]+)/.exec(link)?.[1] ?? link.trim();
  const refusal = /** @type {HTMLElement} */ (document.getElementById('refusal'));
  const answer = await fetch(`./?token=${encodeURIComponent(token)}`, {headers: {'x-status': 'in-header'}}).catch(
    () => null,
  );
  if (answer?.ok && !answer.headers.has('x-status')) location.reload();
  else
    refusal.textContent = answer
      ? 'This is not the link of the workbench that runs now.'
      : 'The workbench does not answer.';
});
