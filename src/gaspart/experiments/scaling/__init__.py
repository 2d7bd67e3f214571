"""What space partitioning buys: naive_scaling, box_count, ideal_boxes, linear_scaling, event_scaling."""
