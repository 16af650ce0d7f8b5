"""Many tracks side by side: how a recursion runs over blocks of lanes."""
