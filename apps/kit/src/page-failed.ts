/**
 * Makes the page that says that another page could not be loaded. It does without React, because React's
 * code may be missing, too.
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
