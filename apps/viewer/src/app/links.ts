import type { PanelProps } from '../engine/panel-props.ts';
import { keyScope } from '../ui/key-scope.ts';

/** Opens the scene that a pasted or dropped link names. */
export function openLink(panel: PanelProps, text: string, isAdded = false): void {
  void import('../engine/open-address.ts').then(({ openText }) => openText(panel, text, isAdded));
}

/** Opens links that are pasted outside of text fields; returns a function that stops this. */
export function listenToPaste(panel: PanelProps): () => void {
  const onPaste = ({ target, clipboardData }: ClipboardEvent) => {
    const text = clipboardData?.getData('text/plain');
    if (text && keyScope(target) !== 'text') openLink(panel, text);
  };
  window.addEventListener('paste', onPaste);
  return () => window.removeEventListener('paste', onPaste);
}
