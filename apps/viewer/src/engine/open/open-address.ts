import type { PanelProps } from '../viewer.ts';

/** The first address in a text, as pasted, typed or dropped; null if it is none. */
export function addressIn(text: string): URL | null {
  // Lists of links have comments.
  const line = text.split(/\r?\n/).find((each) => each.trim() !== '' && !each.startsWith('#'));
  const address = line?.trim() ?? '';
  const isWhole = /^https?:\/\//i.test(address);
  // As people type it, without the scheme: a domain with a dot, and a path.
  if (!isWhole && !/^[\w-]+(\.[\w-]+)+(:\d+)?\/\S+$/.test(address)) return null;
  return URL.parse(isWhole ? address : `https://${address}`);
}

/** Opens the scene at an address; a link to this viewer is opened as it is, with its view. */
export function openAddress({ store, viewer }: PanelProps, url: URL, isAdded = false): void {
  const isLink = url.origin === location.origin && url.pathname === location.pathname;
  if (isLink) {
    location.assign(url);
    return;
  }
  if (isAdded) viewer.scenes.add({ kind: 'url', url });
  else viewer.scenes.open({ kind: 'url', url });
  if (store.getState().dock === 'open') store.setState({ dock: null });
}

/** Opens what was pasted or dropped as a link; says so if it is no address. */
export function openText(panel: PanelProps, text: string, isAdded = false): void {
  const url = addressIn(text);
  if (url) openAddress(panel, url, isAdded);
  else
    panel.store.setState({ notice: 'This is no address of a scene, such as https://example.com/scene.ply.' });
}
