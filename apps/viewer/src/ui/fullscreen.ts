import { useEffect, useState } from 'react';

/** Whether the page, or an element of it, has the whole screen. */
export function useFullscreen(): boolean {
  const [isFullscreen, setFullscreen] = useState(document.fullscreenElement !== null);
  useEffect(() => {
    const read = () => setFullscreen(document.fullscreenElement !== null);
    document.addEventListener('fullscreenchange', read);
    return () => document.removeEventListener('fullscreenchange', read);
  }, []);
  return isFullscreen;
}

export async function toggleFullscreen(): Promise<void> {
  // Browsers may refuse, e.g. inside a frame: the page visibly keeps its size.
  await (document.fullscreenElement
    ? document.exitFullscreen()
    : document.documentElement.requestFullscreen()
  ).catch(() => {});
}
