import { TextButton } from '@websplatter/kit/controls';
import { makePageFailed } from '@websplatter/kit/page-failed';
import { useEffect, useLayoutEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { ViewerState, ViewerStore } from '../state/store.ts';

/**
 * Shown instead of the viewer if the browser lacks WebGPU or the engine's code could not be
 * fetched.
 */
export function UnavailablePage({ store, onRetry }: { store: ViewerStore; onRetry: () => void }) {
  const reason = useStore(store, (state) => state.statusReason);
  const isCodeMissing = useStore(store, (state) => state.isCodeMissing);
  if (isCodeMissing) return <div ref={(div) => div?.replaceChildren(makePageFailed())} />;
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: keys scroll it, where it holds no button.
    <main className="status-page" tabIndex={0} data-testid="webgpu-unavailable">
      <h1>This page needs WebGPU</h1>
      <p>
        WebSplatter sorts and draws millions of Gaussian splats on the graphics processor through WebGPU, the
        web’s interface to modern GPUs.{' '}
        {navigator.gpu
          ? 'This browser has it, but no GPU for it here.'
          : 'This browser does not offer it here.'}
      </p>
      {!isSecureContext && (
        <p>
          <strong>The page was not loaded securely.</strong> Browsers offer WebGPU on https:// and on
          localhost only.
        </p>
      )}
      <h2>Where it works</h2>
      <ul>
        <li>Chrome and Edge 113 or newer on Windows, macOS and ChromeOS; on Android from 121</li>
        <li>Safari 26 or newer on macOS, iOS, iPadOS and visionOS</li>
        <li>Firefox 141 or newer on Windows, 145 or newer on Macs with Apple silicon</li>
        <li>On Linux: Chrome with WebGPU enabled in chrome://flags, or Firefox Nightly</li>
      </ul>
      <p>
        If yours is among them, check that hardware acceleration is on and that the graphics driver is up to
        date.
      </p>
      {/* Without any WebGPU the reason repeats the above. */}
      {navigator.gpu !== undefined && (
        <>
          <p className="particulars" data-testid="status-reason">
            {reason}
          </p>
          <p className="actions">
            <PrimaryButton testId="retry" onClick={onRetry}>
              Try again
            </PrimaryButton>
          </p>
        </>
      )}
    </main>
  );
}

/** Shown over the viewer after the GPU was lost, until it is back. */
export function LostPage(props: {
  store: ViewerStore;
  onRecover: () => void;
  /** Null if the page has no other scene. */
  onSmallScene: (() => void) | null;
}) {
  const { store, onRecover, onSmallScene } = props;
  const reason = useStore(store, (state) => state.statusReason);
  const prospect = useStore(store, prospectOf);
  const dialog = useRef<HTMLDialogElement>(null);
  const show = () => dialog.current?.showModal();
  // Runs before the button takes the focus, which nothing under a modal dialog can have.
  useLayoutEffect(show, []);
  return (
    <dialog
      ref={dialog}
      className="status-page"
      aria-labelledby="lost-title"
      data-testid="device-lost"
      // A close gesture has nothing to return to, so the dialog reopens. `listenToKeys` handles
      // Escape.
      onClose={show}
    >
      <h1 id="lost-title">The connection to the GPU was lost</h1>
      <p>
        This happens when the graphics driver restarts, the computer wakes up, or memory runs out. Your scene
        can be opened again where you were, or another file dropped here.
      </p>
      <p role="status" data-testid="prospect">
        {prospect}
      </p>
      <p className="particulars" data-testid="status-reason">
        {reason}
      </p>
      <p className="actions">
        <PrimaryButton testId="recover" onClick={onRecover}>
          Recover now
        </PrimaryButton>
        {onSmallScene && (
          <TextButton look="plain" testId="open-small-scene" onClick={onSmallScene}>
            Open a small scene
          </TextButton>
        )}
        <TextButton look="plain" testId="reload" onClick={() => location.reload()}>
          Reload the page
        </TextButton>
      </p>
    </dialog>
  );
}

/** A sentence about the next attempt after a lost GPU. */
function prospectOf({ status, retryWaitMs }: ViewerState): string {
  if (status === 'recovering') return 'The viewer is asking for the GPU again…';
  return retryWaitMs === null
    ? 'Several attempts in a row have failed: the GPU’s memory may be too small for the scene, or its driver may be at fault.'
    : `The viewer asks for the GPU again by itself after ${retryWaitMs / 1000} s.`;
}

/** The focused button of a page that replaces the viewer. */
function PrimaryButton(props: { testId: string; onClick: () => void; children: string }) {
  const { testId, onClick, children } = props;
  const button = useRef<HTMLButtonElement>(null);
  useEffect(() => button.current?.focus(), []);
  return (
    <button ref={button} type="button" className="text-button primary" data-testid={testId} onClick={onClick}>
      {children}
    </button>
  );
}
