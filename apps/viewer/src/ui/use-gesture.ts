import { useRef } from 'react';

/**
 * The gesture by which a control is changed: all changes by one press of the pointer, or by keys while the
 * control keeps the focus, which are undone together. Spread `begins` onto the control.
 */
export function useGesture() {
  const gesture = useRef<object>({});
  const begin = () => {
    gesture.current = {};
  };
  return { gesture, begins: { onPointerDown: begin, onFocus: begin } };
}
