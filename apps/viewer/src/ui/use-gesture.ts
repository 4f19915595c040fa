import { useRef } from 'react';

/**
 * The gesture by which a control is changed: all changes by one press of the pointer, or by keys while the
 * control keeps the focus, which are undone together. Spread `begins` onto the control.
 */
export function useGesture() {
  const gesture = useRef<object>({});
  const isPressed = useRef(false);
  const begin = () => {
    gesture.current = {};
  };
  const press = (isDown: boolean) => () => {
    isPressed.current = isDown;
    if (isDown) begin();
  };
  const begins = {
    onPointerDown: press(true),
    onPointerUp: press(false),
    onPointerCancel: press(false),
    // Browsers move a slider's thumb to the pointer before they give it the focus.
    onFocus: () => {
      if (!isPressed.current) begin();
    },
  };
  return { gesture, begins };
}
