import { WebGpuUnavailableError, WebSplatterError } from '@websplatter/core';
import { SplatsUnsupportedRendererError } from '@websplatter/three';
import { Component, createContext, type ReactNode } from 'react';

/** Props of `<SplatsErrorBoundary>`. */
export interface SplatsErrorBoundaryProps {
  children?: ReactNode;
  /**
   * Shown in place of children that have failed, or over the poster of a `<SplatCanvas>`. Default: a
   * sentence with advice, such as another browser.
   */
  fallback?: ReactNode | ((error: WebSplatterError) => ReactNode);
}

/** Advises visitors; details are for developers, who have the console. */
function advise(error: WebSplatterError): ReactNode {
  const isUnsupported =
    error instanceof WebGpuUnavailableError || error instanceof SplatsUnsupportedRendererError;
  return (
    <p role="alert">
      {isUnsupported
        ? 'This 3D view cannot be shown here. Try a recent Chrome, Edge, Firefox or Safari.'
        : 'This 3D view could not be loaded. Reload the page to try again.'}
    </p>
  );
}

/** `fallback` of the nearest `<SplatsErrorBoundary>`; undefined outside of any. */
export const FallbackContext = createContext<SplatsErrorBoundaryProps['fallback']>(undefined);

/**
 * An error boundary for the errors of this package in a `<Canvas>` or `<SplatCanvas>`, all of which are
 * a WebSplatterError: if there is no WebGPU, if the Canvas has a renderer that cannot draw splats, or
 * if a file cannot be read and its `<Splats>` has no `onError`, it shows `fallback` instead. React logs
 * the error with details. Other errors pass through to the next error boundary.
 *
 * The fallback stays until the boundary mounts again: give it a `key` that changes with the file.
 *
 * @example
 * <SplatsErrorBoundary fallback={<img src="/garden.jpg" alt="A garden" />}>
 *   <SplatCanvas>
 *     <Splats src="/garden.ply" />
 *   </SplatCanvas>
 * </SplatsErrorBoundary>
 */
export class SplatsErrorBoundary extends Component<SplatsErrorBoundaryProps, { readonly error: unknown }> {
  override state: { readonly error: unknown } = { error: null };

  static getDerivedStateFromError(error: unknown): { readonly error: unknown } {
    return { error };
  }

  override render(): ReactNode {
    const { children, fallback = advise } = this.props;
    const { error } = this.state;
    if (error === null) return <FallbackContext value={fallback}>{children}</FallbackContext>;
    if (!(error instanceof WebSplatterError)) throw error;
    return typeof fallback === 'function' ? fallback(error) : fallback;
  }
}
