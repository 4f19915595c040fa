import { WebGpuUnavailableError } from '@websplatter/core';
import { SplatsUnsupportedRendererError } from '@websplatter/three';
import { Component, createContext, type ReactNode } from 'react';

type SupportError = WebGpuUnavailableError | SplatsUnsupportedRendererError;

/** Props of `<SplatsErrorBoundary>`. */
export interface SplatsErrorBoundaryProps {
  children?: ReactNode;
  /**
   * Shown in place of children that cannot draw, or over the poster of a `<SplatCanvas>`. Default: a
   * sentence with advice, such as another browser.
   */
  fallback?: ReactNode | ((error: SupportError) => ReactNode);
}

const SENTENCE = (
  <p role="alert">This 3D view cannot be shown here. Try a recent Chrome, Edge, Firefox or Safari.</p>
);

/** `fallback` of the nearest `<SplatsErrorBoundary>`; undefined outside of any. */
export const FallbackContext = createContext<SplatsErrorBoundaryProps['fallback']>(undefined);

/**
 * An error boundary for a `<Canvas>` or `<SplatCanvas>`, for the errors of devices that cannot draw
 * splats: if there is no WebGPU, or the Canvas has a renderer that cannot draw splats, it shows
 * `fallback` instead; React logs the error with details. Other errors, such as those of files, pass
 * through to the next error boundary.
 *
 * @example
 * <SplatsErrorBoundary fallback={<img src="garden.jpg" alt="A garden" />}>
 *   <SplatCanvas>
 *     <Splats src="garden.ply" />
 *   </SplatCanvas>
 * </SplatsErrorBoundary>
 */
export class SplatsErrorBoundary extends Component<SplatsErrorBoundaryProps, { readonly error: unknown }> {
  override state: { readonly error: unknown } = { error: null };

  static getDerivedStateFromError(error: unknown): { readonly error: unknown } {
    return { error };
  }

  override render(): ReactNode {
    const { children, fallback = SENTENCE } = this.props;
    const { error } = this.state;
    if (error === null) return <FallbackContext value={fallback}>{children}</FallbackContext>;
    if (!(error instanceof WebGpuUnavailableError || error instanceof SplatsUnsupportedRendererError))
      throw error;
    return typeof fallback === 'function' ? fallback(error) : fallback;
  }
}
