/**
 * Makes what is shown instead of a page whose code could not be loaded. Without React, which may be part
 * of what is missing.
 */
export function makePageFailed(): HTMLElement {
  const page = document.createElement('main');
  page.className = 'status-page';
  page.dataset.testid = 'page-failed';
  page.innerHTML = `<h1>This page could not be loaded</h1>
<p role="alert">Check the connection. The browser’s console has details.</p>
<p class="actions"><button type="button" class="text-button primary">Try again</button></p>`;
  page.querySelector('button')!.onclick = () => location.reload();
  return page;
}
