import { IS_ONE_FILE } from '../engine/link/lab-address.ts';
import { linkedViewOf, linkTo } from '../engine/link/page-address.ts';
import type { Viewer } from '../engine/viewer.ts';
import { counted } from '../state/describe-edits.ts';
import { countOf } from '../state/selecting.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';

/** What does more than a link; the viewer as one file cannot save pages. */
const INSTEAD = IS_ONE_FILE ? 'Save the scene as a file' : 'Save a web page';

/** Why there is no link to the scene that is shown. */
export function noLink(viewer: Viewer): string {
  return viewer.scenes.newest?.parts.some(({ source }) => source.kind === 'file')
    ? `This file is only on your device, so a link cannot open it. ${INSTEAD} instead.`
    : `A link can only open files on servers (?src=…&src=…), and some of this scene is not on one. ${INSTEAD} instead.`;
}

/** The whole address that shows this picture elsewhere; null if no address can name its files. */
export function linkOf(viewer: Viewer, store: ViewerStore): string | null {
  return linkTo(new URL(location.href), linkedViewOf(viewer, store.getState()));
}

/** Copies the link and says so. If the browser forbids it, opens the panel that shows the link. */
export async function copyLink(viewer: Viewer, store: ViewerStore): Promise<void> {
  const link = linkOf(viewer, store);
  if (link === null) {
    // The command closes the panel where it is open.
    const offers = store.getState().dock === 'save' ? [] : ([{ label: INSTEAD, command: 'save' }] as const);
    store.setState({ saveTab: IS_ONE_FILE ? 'file' : 'share', notice: { text: noLink(viewer), offers } });
    return;
  }
  try {
    // There is no clipboard where the page does not come by HTTPS.
    await navigator.clipboard.writeText(link);
    store.setState({ notice: copied(store.getState()) });
  } catch {
    const notice = 'The browser does not let this page copy. Copy the link from Save and share (X).';
    store.setState({ dock: 'save', saveTab: 'share', notice });
  }
}

/** The notice for a copied link, with the edits that it lacks. */
export function copied(state: Pick<ViewerState, 'inspecting'>): string {
  const lacking = lackingInLinks(state);
  return lacking === null
    ? 'The link is copied: it shows this picture in a window of the same size.'
    : `The link is copied: it shows this view ${lacking}`;
}

/**
 * Edits that links cannot hold, as in `without your 918 removals and 1 ruler.`, with advice; null if
 * there are none.
 */
export function lackingInLinks({ inspecting }: Pick<ViewerState, 'inspecting'>): string | null {
  const { rulers, selecting } = inspecting;
  const removed = countOf(selecting.removed);
  const lacks = [
    ...(removed > 0 ? [counted(removed, 'removal')] : []),
    ...(rulers.length > 0 ? [counted(rulers.length, 'ruler')] : []),
  ];
  if (lacks.length === 0) return null;
  const advice = removed > 0 ? ` ${INSTEAD} to share it as you see it.` : '';
  return `without your ${lacks.join(' and ')}.${advice}`;
}

/** Copies the text of a frame and says so, or that the browser forbids it. */
export async function copyFrame(text: string, store: ViewerStore): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    store.setState({ notice: 'The embed code is copied: paste it into the HTML of a page.' });
  } catch {
    store.setState({ notice: 'The browser does not let this page copy. Select the text and copy it.' });
  }
}
