import { PageRefusal } from './held-parts.ts';

/**
 * The text of the page that scenes are put into. It is fetched only when somebody saves one.
 *
 * @throws PageRefusal where it cannot be fetched; the signal's reason once that is aborted.
 */
export async function fetchScenePage(signal: AbortSignal): Promise<string> {
  try {
    const { default: address } = await import('virtual:scene-page');
    const response = await fetch(address, { signal });
    if (!response.ok) throw new Error(`The server answers ${response.status}`);
    return await response.text();
  } catch (error) {
    signal.throwIfAborted();
    console.error(error);
    throw new PageRefusal(
      'The code of the page could not be fetched.',
      'Check the connection, then reload the viewer.',
    );
  }
}
